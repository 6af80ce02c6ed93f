#include "pliant/plants/parameter_file.h"

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/parser.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <fstream>
#include <limits>
#include <map>
#include <numbers>
#include <set>
#include <sstream>

#include "pliant/plants/parameter_text.h"
#include "pliant/systems/nearest_name.h"

namespace pliant {

namespace {

[[noreturn]] void FailAt(const std::string& source, const YAML::Mark& mark,
                         const std::string& what) {
  if (mark.is_null()) throw Error(source + ": " + what);
  throw Error(source + ":" + Text(mark.line + 1) + ":" + Text(mark.column + 1) + ": " + what);
}

/// A word of the file as it stands in messages, where it has no end.
std::string Short(const std::string& word) {
  constexpr std::size_t kMost = 60;
  return word.size() > kMost ? word.substr(0, kMost) + "…" : word;
}

std::string Quoted(const std::string& word) { return "'" + Short(word) + "'"; }

std::string Lowercase(std::string_view word) {
  std::string all(word);
  for (char& c : all)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return all;
}

std::string Listed(const std::vector<std::string>& names) {
  std::string list;
  for (const std::string& name : names) list += (list.empty() ? "" : ", ") + Short(name);
  return list;
}

/// The YAML reader takes some 220 bytes for each bracket.
constexpr std::size_t kMostBytes = 512 << 10;

void RequireSize(const std::string& text, const std::string& source) {
  if (text.size() > kMostBytes)
    throw Error(source + ": a file of parameters has at most " + Text(kMostBytes >> 10) + " KiB");
}

/// The text of a file; nothing where it cannot be read to its end.
std::optional<std::string> ContentOf(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::string text;
  for (char c = 0; text.size() <= kMostBytes && in.get(c);) text += c;
  if (!in.is_open() || in.bad()) return {};
  return text;
}

/// A unit that may stand for another, and what it is in it.
struct UnitName {
  std::string_view name, of;
  double factor;
};

constexpr double kDegree = std::numbers::pi / 180;
constexpr std::array kUnitNames{
    UnitName{"ms", "s", 1e-3},       UnitName{"us", "s", 1e-6},
    UnitName{"ns", "s", 1e-9},       UnitName{"min", "s", 60},
    UnitName{"mm", "m", 1e-3},       UnitName{"cm", "m", 1e-2},
    UnitName{"deg", "rad", kDegree}, UnitName{"deg/s", "rad/s", kDegree},
    UnitName{"mm/s", "m/s", 1e-3},   UnitName{"g", "kg", 1e-3},
    UnitName{"mA", "A", 1e-3},       UnitName{"Nm", "N·m", 1},
    UnitName{"N m", "N·m", 1},       UnitName{"kg m²", "kg·m²", 1}};

/// What one `name` is in `unit`; 0: something else.
double FactorOf(std::string_view name, std::string_view unit) {
  if (name.empty() || name == unit) return 1;
  for (const UnitName& known : kUnitNames)
    if (known.name == name && known.of == unit) return known.factor;
  return 0;
}

std::string InUnit(std::string_view unit) {
  return unit.empty() ? std::string() : " [" + std::string(unit) + "]";
}

/// A number and what stands behind it: "200 N/m".
struct Amount {
  double number;
  std::string unit;
};

/// How YAML writes what is no finite number.
std::optional<double> SpecialNumber(std::string_view word) {
  constexpr double kInf = std::numeric_limits<double>::infinity();
  constexpr std::array<std::pair<std::string_view, double>, 4> kAll{
      {{".inf", kInf},
       {"+.inf", kInf},
       {"-.inf", -kInf},
       {".nan", std::numeric_limits<double>::quiet_NaN()}}};
  const auto found =
      std::ranges::find(kAll, Lowercase(word), &std::pair<std::string_view, double>::first);
  return found == kAll.end() ? std::nullopt : std::optional(found->second);
}

std::optional<Amount> AmountOf(std::string_view word) {
  if (const auto special = SpecialNumber(word)) return Amount{*special, ""};
  if (word.starts_with('+') && !word.starts_with("+-")) word.remove_prefix(1);
  Amount amount{0, ""};
  const auto [behind, error] =
      std::from_chars(word.data(), word.data() + word.size(), amount.number);
  if (error != std::errc{}) return {};
  const std::size_t unit =
      word.find_first_not_of(' ', static_cast<std::size_t>(behind - word.data()));
  if (unit != std::string::npos) amount.unit = word.substr(unit);
  return amount;
}

/// A word as YAML inside a list or map.
std::string WordText(const std::string& word, bool quoted) {
  const auto is_letter = [](unsigned char c) { return c < 0x80 && (std::isalnum(c) || c == '_'); };
  const auto is_plain = [&](unsigned char c) {
    return is_letter(c) ||
           std::string_view(" .+-/").find(static_cast<char>(c)) != std::string::npos;
  };
  const std::size_t first = word.find_first_not_of(".+-");
  const bool plain = !quoted && Lowercase(word) != "null" && std::ranges::all_of(word, is_plain) &&
                     !word.ends_with(' ') && first <= 2 &&
                     is_letter(static_cast<unsigned char>(word[first]));
  return plain ? word : internal::YamlText(word);
}

}  // namespace

/// What was read, or put there by Set. Aliases share what they stand for, so nothing of it changes.
struct ParameterFile::Node {
  enum class Kind { Nothing, Word, List, Map };
  struct Entry {
    std::string key;  // of a map
    YAML::Mark mark;  // of the key
    std::shared_ptr<const Node> value;
  };

  Kind kind = Kind::Nothing;
  std::shared_ptr<const std::string> source = {};
  YAML::Mark mark = YAML::Mark::null_mark();  // null: not of a file
  std::string tag = {};
  std::string word = {};
  bool quoted = false;
  std::vector<Entry> inner = {};
  std::size_t size = 1;   // how many values it is, with those inside
  std::size_t bytes = 0;  // of their words, keys and tags

  bool IsMapOrNothing() const { return kind == Kind::Map || kind == Kind::Nothing; }

  std::string KindText() const {
    switch (kind) {
      case Kind::Map:
        return "a map";
      case Kind::List:
        return "a list";
      case Kind::Word:
        return Quoted(word);
      default:
        return "nothing";
    }
  }

  std::string yaml() const {
    const std::string begin = tag.empty() ? "" : "!" + tag + " ";
    if (kind == Kind::Word) return begin + WordText(word, quoted);
    if (kind == Kind::Nothing) return begin + "~";
    std::string all;
    for (const Entry& entry : inner)
      all += (all.empty() ? "" : ", ") +
             (kind == Kind::Map ? WordText(entry.key, false) + ": " : "") + entry.value->yaml();
    return begin + (kind == Kind::Map ? "{" + all + "}" : "[" + all + "]");
  }

  /// With the value at `path` replaced; everything else is shared.
  std::shared_ptr<const Node> With(const std::string& path,
                                   const std::shared_ptr<const Node>& value) const {
    const std::size_t dot = path.find('.');
    const std::string key = path.substr(0, dot);
    const auto fail = [&](const std::string& what) { throw Error(*value->source + ": " + what); };
    if (key.empty()) fail("expected a path such as controller.pose.stiffness");
    const auto place = inner.begin() + std::ptrdiff_t(PlaceOf(key, *value->source));
    std::shared_ptr<const Node> child = value;
    if (dot != std::string::npos) {
      child = place == inner.end() ? std::make_shared<const Node>() : place->value;
      if (child->kind == Kind::Nothing) {
        Node made = *child;
        made.source = value->source;
        made.mark = YAML::Mark::null_mark();
        child = std::make_shared<const Node>(std::move(made));
      }
      child = child->With(path.substr(dot + 1), value);
    }
    Node changed = *this;
    if (kind == Kind::Nothing) changed.kind = Kind::Map;
    Entry entry{key, YAML::Mark::null_mark(), child};
    if (place == inner.end()) {
      changed.inner.push_back(std::move(entry));
    } else {
      if (dot != std::string::npos) entry.mark = place->mark;
      changed.inner[std::size_t(place - inner.begin())] = std::move(entry);
    }
    return std::make_shared<const Node>(std::move(changed));
  }

 private:
  /// Where the value of a key is; at the end of a map if it has none.
  std::size_t PlaceOf(const std::string& key, const std::string& from) const {
    if (kind == Kind::Word)
      throw Error(from + ": there is nothing inside " + KindText() + " to set as " + Quoted(key));
    if (kind != Kind::List)
      return std::size_t(std::ranges::find(inner, key, &Entry::key) - inner.begin());
    std::size_t index = 0;
    const auto [end, error] = std::from_chars(key.data(), key.data() + key.size(), index);
    if (error != std::errc{} || end != key.data() + key.size() || index >= inner.size())
      throw Error(from + ": " + Quoted(key) + " is none of the " + Text(inner.size()) +
                  " elements, which are numbered from 0");
    return index;
  }
};

/// Makes nodes of a text. Refuses what is YAML and no parameter file as it is read, before there is
/// more of it than fits.
class ParameterFile::Reader final : public YAML::EventHandler {
 public:
  Reader(const std::string& source, bool is_file)
      : source_{std::make_shared<const std::string>(source)}, is_file_{is_file} {
    root_ = Made({});
  }

  std::shared_ptr<const Node> Read(const std::string& text) try {
    RequireSize(text, *source_);
    std::istringstream in(text);
    YAML::Parser parser(in);
    while (parser.HandleNextDocument(*this)) {
    }
    return root_;
  } catch (const YAML::Exception& e) {
    Fail(e.mark, e.msg);
  }

  void OnDocumentStart(const YAML::Mark& mark) override {
    if (++documents_ > 1) Fail(mark, "a second document begins here; expected one");
  }
  void OnDocumentEnd() override {}

  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    ExpectValue(mark, 1);
    Put(Made({.mark = Place(mark)}), anchor);
  }
  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                const std::string& word) override {
    if (at_key()) {
      if (word.size() > kMostOfKey)
        Fail(mark, "the key " + Quoted(word) + " has more than " + Text(kMostOfKey) + " bytes");
      if (!open_.back().keys.insert(word).second) Fail(mark, Quoted(word) + " is given twice");
      open_.back().node.inner.push_back({word, Place(mark), nullptr});
      open_.back().node.bytes += word.size();
      return;
    }
    ExpectValue(mark, 1);
    const std::string given = TagOf(tag);
    // A tag with nothing behind it comes as an empty word.
    const bool nothing = !given.empty() && (word.empty() || word == "~");
    Put(Made({.kind = nothing ? Node::Kind::Nothing : Node::Kind::Word,
              .mark = Place(mark),
              .tag = given,
              .word = word,
              .quoted = tag != "?",
              .bytes = word.size() + given.size()}),
        anchor);
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    if (std::ranges::find(open_, anchor, &Collection::anchor) != open_.end())
      Fail(mark, "an alias stands for what it is a part of");
    const auto found = anchored_.find(anchor);
    ExpectValue(mark, found == anchored_.end() ? 1 : found->second->size);
    if (found != anchored_.end()) bytes_of_aliases_ += found->second->bytes;
    if (bytes_of_aliases_ > kMostBytes)
      Fail(mark, "more than " + Text(kMostBytes >> 10) +
                     " KiB, the words of an alias counted wherever it stands");
    Put(found == anchored_.end() ? Made({.mark = Place(mark)}) : found->second, 0);
  }

  void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    Open(Node::Kind::Map, mark, tag, anchor);
  }
  void OnMapEnd() override { CloseLast(); }
  void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    Open(Node::Kind::List, mark, tag, anchor);
  }
  void OnSequenceEnd() override { CloseLast(); }

 private:
  static constexpr std::size_t kMostOpen = 32, kMostValues = 100'000;
  static constexpr std::size_t kMostOfKey = 255;  // YAML reads 1024 letters; \x1b of one byte are 4

  struct Collection {
    Node node;
    YAML::anchor_t anchor;
    std::set<std::string> keys;
  };

  [[noreturn]] void Fail(const YAML::Mark& mark, const std::string& what) const {
    FailAt(*source_, Place(mark), what);
  }
  YAML::Mark Place(const YAML::Mark& mark) const {
    return is_file_ ? mark : YAML::Mark::null_mark();
  }
  static std::string TagOf(const std::string& tag) {
    return tag.starts_with('!') ? tag.substr(1) : "";
  }
  std::shared_ptr<const Node> Made(Node node) const {
    node.source = source_;
    return std::make_shared<const Node>(std::move(node));
  }

  /// Whether the next thing in a map is a key.
  bool at_key() const {
    if (open_.empty() || open_.back().node.kind != Node::Kind::Map) return false;
    return open_.back().node.inner.empty() || open_.back().node.inner.back().value;
  }
  void ExpectValue(const YAML::Mark& mark, std::size_t size) {
    if (at_key()) Fail(mark, "a key must be a word");
    values_ += size;
    if (values_ > kMostValues)
      Fail(mark, "more than " + Text(kMostValues) +
                     " values, those of an alias counted wherever it stands");
  }
  void Put(std::shared_ptr<const Node> node, YAML::anchor_t anchor) {
    if (anchor != 0) anchored_[anchor] = node;
    if (open_.empty()) {
      root_ = std::move(node);
      return;
    }
    Node& in = open_.back().node;
    in.size += node->size;
    in.bytes += node->bytes;
    if (in.kind == Node::Kind::Map)
      in.inner.back().value = std::move(node);
    else
      in.inner.push_back({"", YAML::Mark::null_mark(), std::move(node)});
  }
  void Open(Node::Kind kind, const YAML::Mark& mark, const std::string& tag,
            YAML::anchor_t anchor) {
    ExpectValue(mark, 1);
    if (open_.size() == kMostOpen)
      Fail(mark, "more than " + Text(kMostOpen) + " maps and lists inside one another");
    const std::string given = TagOf(tag);
    open_.push_back(
        {{.kind = kind, .mark = Place(mark), .tag = given, .bytes = given.size()}, anchor, {}});
  }
  void CloseLast() {
    Collection last = std::move(open_.back());
    open_.pop_back();
    Put(Made(std::move(last.node)), last.anchor);
  }

  const std::shared_ptr<const std::string> source_;
  const bool is_file_;
  int documents_ = 0;
  std::size_t values_ = 0, bytes_of_aliases_ = 0;
  std::shared_ptr<const Node> root_;
  std::vector<Collection> open_;  // from the outermost to the one that is read
  std::map<YAML::anchor_t, std::shared_ptr<const Node>> anchored_;
};

ParameterFile ParameterFile::Read(const std::filesystem::path& file) {
  return ReadText(TextOf(file), file.string());
}

std::string ParameterFile::TextOf(const std::filesystem::path& file) {
  std::error_code none;
  const std::optional<std::string> text =
      std::filesystem::is_directory(file, none) ? std::nullopt : ContentOf(file);
  if (!text) throw Error(file.string() + ": cannot be read");
  RequireSize(*text, file.string());
  return *text;
}

ParameterFile ParameterFile::ReadText(const std::string& text, const std::string& source) {
  return ParameterFile(Reader(source, true).Read(text));
}

void ParameterFile::Set(const std::string& path, const std::string& yaml,
                        const std::string& source) {
  node_ = node_->With(path, Reader(source, false).Read(yaml));
}

void ParameterFile::Fail(const std::string& what) const {
  FailAt(*node_->source, node_->mark, what);
}

bool ParameterFile::IsNull() const { return node_->kind == Node::Kind::Nothing; }

bool ParameterFile::IsList() const { return node_->kind == Node::Kind::List; }

std::string ParameterFile::yaml() const {
  std::string text = node_->yaml();
  if (text.size() > kMostBytes)
    Fail("in one line, without aliases, it is longer than " + Text(kMostBytes >> 10) + " KiB");
  return text;
}

std::string ParameterFile::tag() const { return node_->tag; }

void ParameterFile::FailTag(const std::vector<std::string>& known) const {
  std::string list;
  for (const std::string& name : known) list += (list.empty() ? "!" : ", !") + name;
  if (tag().empty()) Fail("expected a tag that says what it is: one of " + list);
  Fail("there is no !" + Short(tag()) + " here" + DidYouMean(Short(tag()), known) +
       "\n  known: " + list);
}

bool ParameterFile::flag() const {
  const std::string word = node_->kind == Node::Kind::Word ? Lowercase(node_->word) : "";
  const bool on = word == "true" || word == "yes" || word == "on";
  if (!on && word != "false" && word != "no" && word != "off")
    Fail("expected true or false, got " + node_->KindText());
  return on;
}

double ParameterFile::number() const { return NumberIn("", "", {.most = kUnbounded}); }

double ParameterFile::NumberIn(std::string_view name, std::string_view unit,
                               const Range& range) const {
  const std::optional<Amount> amount = AmountOf(node_->word);
  if (!amount) Fail("expected a number" + InUnit(unit) + ", got " + node_->KindText());
  const double factor = FactorOf(amount->unit, unit);
  if (factor == 0)
    Fail((unit.empty() ? "expected a number without a unit" : "expected a number" + InUnit(unit)) +
         ", got " + node_->KindText());
  const double value = factor * amount->number;
  try {
    RequireInRange("", name, value, unit, range);
  } catch (const Error& e) {
    Fail(e.what());
  }
  return value;
}

Duration ParameterFile::duration() const {
  const std::optional<Amount> amount = AmountOf(node_->word);
  if (amount && amount->unit == "Hz" && amount->number >= 1 && amount->number <= 1e9 &&
      amount->number == std::floor(amount->number))
    return Hertz(static_cast<std::int64_t>(amount->number));
  const double factor = amount ? FactorOf(amount->unit, "s") : 0;
  const double ns = amount ? std::round(1e9 * factor * amount->number) : 0;
  if (!amount || amount->unit.empty() || factor == 0 || !(ns >= 0) || ns > 9e18)
    Fail("expected a time such as 1 ms or a rate such as 30 Hz, got " + node_->KindText());
  return Duration::Nanoseconds(static_cast<std::int64_t>(ns));
}

std::vector<ParameterFile> ParameterFile::elements() const {
  if (IsNull()) return {};
  if (node_->kind != Node::Kind::List) Fail("expected a list, got " + node_->KindText());
  std::vector<ParameterFile> all;
  for (const Node::Entry& entry : node_->inner) all.push_back(ParameterFile(entry.value));
  return all;
}

std::vector<ParameterFile> ParameterFile::ElementsOf(std::ptrdiff_t fixed,
                                                     std::ptrdiff_t most) const {
  std::vector<ParameterFile> all = elements();
  if (fixed >= 0 && std::ssize(all) != fixed)
    Fail("expected a list of " + Text(fixed) + ", got one of " + Text(all.size()));
  if (fixed < 0 && std::ssize(all) > most)
    Fail("expected a list of at most " + Text(most) + ", got one of " + Text(all.size()));
  return all;
}

std::string ParameterFile::text() const {
  if (node_->kind != Node::Kind::Word) Fail("expected a word, got " + node_->KindText());
  return node_->word;
}

std::size_t ParameterFile::OneOf(const std::vector<std::string>& known) const {
  const std::string word = text();
  const auto found = std::ranges::find(known, word);
  if (found == known.end())
    Fail("expected one of " + Listed(known) + ", got " + Quoted(word) +
         DidYouMean(Short(word), known));
  return static_cast<std::size_t>(found - known.begin());
}

std::vector<std::pair<std::string, ParameterFile>> ParameterFile::entries() const {
  if (!node_->IsMapOrNothing()) Fail("expected a map, got " + node_->KindText());
  std::vector<std::pair<std::string, ParameterFile>> all;
  for (const Node::Entry& entry : node_->inner)
    all.emplace_back(entry.key, ParameterFile(entry.value));
  return all;
}

std::optional<ParameterFile> ParameterFile::Find(std::string_view key) const {
  if (!node_->IsMapOrNothing()) Fail("expected a map, got " + node_->KindText());
  const auto found = std::ranges::find(node_->inner, key, &Node::Entry::key);
  if (found == node_->inner.end()) return {};
  return ParameterFile(found->value);
}

ParameterFile ParameterFile::operator[](std::string_view key) const {
  const std::optional<ParameterFile> found = Find(key);
  if (!found) Fail("'" + std::string(key) + "' is missing");
  return *found;
}

void ParameterFile::RequireKeys(const std::vector<std::string>& known) const {
  if (!node_->IsMapOrNothing()) Fail("expected a map, got " + node_->KindText());
  for (const auto& [key, mark, value] : node_->inner)
    if (std::ranges::find(known, key) == known.end())
      FailAt(*value->source, mark,
             "there is no " + Quoted(key) + " here" + DidYouMean(Short(key), known) +
                 "\n  known: " + Listed(known));
}

}  // namespace pliant
