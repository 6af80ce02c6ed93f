#include "pliant/plants/parameter_file.h"

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <numbers>
#include <set>
#include <sstream>

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

std::string KindOf(const YAML::Node& node) {
  switch (node.Type()) {
    case YAML::NodeType::Map:
      return "a map";
    case YAML::NodeType::Sequence:
      return "a list";
    case YAML::NodeType::Scalar:
      return Quoted(node.Scalar());
    default:
      return "nothing";
  }
}

std::string Listed(const std::vector<std::string>& names) {
  std::string list;
  for (const std::string& name : names) list += (list.empty() ? "" : ", ") + Short(name);
  return list;
}

/// Refuses what is YAML and no parameter file, as it is read: before there are nodes that contain
/// themselves, or more of them than the stack can hold.
class Check final : public YAML::EventHandler {
 public:
  explicit Check(const std::string& source) : source_{source} {}

  void OnDocumentStart(const YAML::Mark& mark) override {
    if (++documents_ > 1) FailAt(source_, mark, "a second document begins here; expected one");
  }
  void OnDocumentEnd() override {}

  void OnNull(const YAML::Mark& mark, YAML::anchor_t) override { ExpectValue(mark); }
  void OnScalar(const YAML::Mark& mark, const std::string&, YAML::anchor_t,
                const std::string& word) override {
    if (!at_key()) return ExpectValue(mark);
    open_.back().at_key = false;
    if (!open_.back().keys.insert(word).second)
      FailAt(source_, mark, Quoted(word) + " is given twice");
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    ExpectValue(mark);
    if (std::ranges::find(open_, anchor, &Collection::anchor) != open_.end())
      FailAt(source_, mark, "an alias stands for what it is a part of");
  }

  void OnMapStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    Open(mark, {.map = true, .at_key = true, .anchor = anchor, .keys = {}});
  }
  void OnMapEnd() override { open_.pop_back(); }
  void OnSequenceStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    Open(mark, {.map = false, .at_key = false, .anchor = anchor, .keys = {}});
  }
  void OnSequenceEnd() override { open_.pop_back(); }

 private:
  static constexpr std::size_t kMostOpen = 32;

  struct Collection {
    bool map;
    bool at_key;  // whether the next thing in a map is a key
    YAML::anchor_t anchor;
    std::set<std::string> keys;
  };

  bool at_key() const { return !open_.empty() && open_.back().at_key; }

  void ExpectValue(const YAML::Mark& mark) {
    if (at_key()) FailAt(source_, mark, "a key must be a word");
    if (!open_.empty()) open_.back().at_key = open_.back().map;
  }
  void Open(const YAML::Mark& mark, Collection collection) {
    ExpectValue(mark);
    if (open_.size() == kMostOpen)
      FailAt(source_, mark, "more than " + Text(kMostOpen) + " maps and lists inside one another");
    open_.push_back(std::move(collection));
  }

  const std::string& source_;
  int documents_ = 0;
  std::vector<Collection> open_;  // from the outermost to the one that is read
};

constexpr std::size_t kMostBytes = 4 << 20;

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
constexpr std::array kUnitNames{UnitName{"ms", "s", 1e-3},
                                UnitName{"us", "s", 1e-6},
                                UnitName{"min", "s", 60},
                                UnitName{"mm", "m", 1e-3},
                                UnitName{"cm", "m", 1e-2},
                                UnitName{"deg", "rad", kDegree},
                                UnitName{"deg/s", "rad/s", kDegree},
                                UnitName{"mm/s", "m/s", 1e-3},
                                UnitName{"g", "kg", 1e-3},
                                UnitName{"mA", "A", 1e-3},
                                UnitName{"Nm", "N·m", 1},
                                UnitName{"N m", "N·m", 1},
                                UnitName{"kg m²", "kg·m²", 1}};

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

std::optional<Amount> AmountOf(const YAML::Node& node) {
  if (!node.IsScalar()) return {};
  const std::string& word = node.Scalar();
  Amount amount{0, ""};
  if (YAML::convert<double>::decode(node, amount.number)) return amount;
  const char* const begin = word.data() + (word.starts_with('+') ? 1 : 0);
  const char* const end = word.data() + word.size();
  const auto [behind, error] = std::from_chars(begin, end, amount.number);
  if (error != std::errc{}) return {};
  const std::size_t unit =
      word.find_first_not_of(' ', static_cast<std::size_t>(behind - word.data()));
  if (unit != std::string::npos) amount.unit = word.substr(unit);
  return amount;
}

/// What has been put in the place of values of the file, and where it came from.
struct Document {
  YAML::Node root;
  std::vector<std::pair<YAML::Node, std::string>> overrides = {};
};

}  // namespace

struct ParameterFile::Node {
  std::shared_ptr<Document> document;
  YAML::Node yaml;
  std::string source;
  bool of_file = true;  // not put there by Set

  /// A place inside this one.
  std::shared_ptr<const Node> Inner(const YAML::Node& at) const {
    for (const auto& [node, from] : document->overrides)
      if (node.is(at)) return std::make_shared<const Node>(Node{document, at, from, false});
    return std::make_shared<const Node>(Node{document, at, source, of_file});
  }
  [[noreturn]] void Fail(const YAML::Mark& mark, const std::string& what) const {
    FailAt(source, of_file ? mark : YAML::Mark::null_mark(), what);
  }
};

ParameterFile ParameterFile::Read(const std::filesystem::path& file) {
  return ReadText(TextOf(file), file.string());
}

std::string ParameterFile::TextOf(const std::filesystem::path& file) {
  std::error_code none;
  const std::optional<std::string> text =
      std::filesystem::is_directory(file, none) ? std::nullopt : ContentOf(file);
  if (!text) throw Error(file.string() + ": cannot be read");
  if (text->size() > kMostBytes)
    throw Error(file.string() + ": a file of parameters has at most 4 MiB");
  return *text;
}

ParameterFile ParameterFile::ReadText(const std::string& text, const std::string& source) try {
  std::istringstream in(text);
  YAML::Parser parser(in);
  Check check(source);
  while (parser.HandleNextDocument(check)) {
  }
  const auto document = std::make_shared<Document>(Document{YAML::Load(text)});
  return ParameterFile(std::make_shared<const Node>(Node{document, document->root, source}));
} catch (const YAML::Exception& e) {
  FailAt(source, e.mark, e.msg);
}

void ParameterFile::Set(const std::string& path, const std::string& yaml,
                        const std::string& source) {
  Document& document = *node_->document;
  const YAML::Node value = ReadText(yaml, source).node_->yaml;
  YAML::Node at = node_->yaml;
  const auto put = [&](YAML::Node parent, const std::string& key, const YAML::Node& child) {
    if (parent.IsSequence()) {
      std::size_t index = 0;
      const auto [end, error] = std::from_chars(key.data(), key.data() + key.size(), index);
      if (error != std::errc{} || end != key.data() + key.size() || index >= parent.size())
        throw Error(source + ": '" + Short(key) + "' is none of the " + Text(parent.size()) +
                    " elements, which are numbered from 0");
      if (child.IsDefined()) parent[index] = child;
      return parent[index];
    }
    if (!parent.IsMap() && !parent.IsNull())
      throw Error(source + ": there is nothing inside " + KindOf(parent) + " to set as '" +
                  Short(key) + "'");
    if (child.IsDefined()) parent[key] = child;
    return parent[key];
  };
  for (std::size_t begin = 0; begin <= path.size();) {
    const std::size_t dot = std::min(path.find('.', begin), path.size());
    const std::string key = path.substr(begin, dot - begin);
    if (key.empty()) throw Error(source + ": expected a path such as controller.pose.stiffness");
    begin = dot + 1;
    const bool last = dot == path.size();
    YAML::Node inner = last ? value : YAML::Node(YAML::NodeType::Undefined);
    inner.reset(put(at, key, last ? value : YAML::Node(YAML::NodeType::Undefined)));
    if (!last && (!inner.IsDefined() || inner.IsNull())) {
      const YAML::Node map(YAML::NodeType::Map);
      inner.reset(put(at, key, map));
      document.overrides.emplace_back(inner, source);
    }
    if (last) document.overrides.emplace_back(inner, source);
    at.reset(inner);
  }
}

void ParameterFile::Fail(const std::string& what) const { node_->Fail(node_->yaml.Mark(), what); }

bool ParameterFile::IsNull() const { return node_->yaml.IsNull(); }

std::string ParameterFile::yaml() const {
  YAML::Emitter out;
  out << YAML::Flow << node_->yaml;
  return out.c_str();
}

std::string ParameterFile::tag() const {
  const std::string& tag = node_->yaml.Tag();
  return tag.starts_with("!") && tag.size() > 1 ? tag.substr(1) : "";
}

void ParameterFile::FailTag(const std::vector<std::string>& known) const {
  std::string list;
  for (const std::string& name : known) list += (list.empty() ? "!" : ", !") + name;
  if (tag().empty()) Fail("expected a tag that says what it is: one of " + list);
  Fail("there is no !" + Short(tag()) + " here" + DidYouMean(Short(tag()), known) +
       "\n  known: " + list);
}

bool ParameterFile::flag() const {
  bool value = false;
  if (!node_->yaml.IsScalar() || !YAML::convert<bool>::decode(node_->yaml, value))
    Fail("expected true or false, got " + KindOf(node_->yaml));
  return value;
}

double ParameterFile::number() const { return NumberIn("", "", {.most = kUnbounded}); }

double ParameterFile::NumberIn(std::string_view name, std::string_view unit,
                               const Range& range) const {
  const std::optional<Amount> amount = AmountOf(node_->yaml);
  if (!amount) Fail("expected a number" + InUnit(unit) + ", got " + KindOf(node_->yaml));
  const double factor = FactorOf(amount->unit, unit);
  if (factor == 0)
    Fail((unit.empty() ? "expected a number without a unit" : "expected a number" + InUnit(unit)) +
         ", got " + KindOf(node_->yaml));
  const double value = factor * amount->number;
  try {
    RequireInRange("", name, value, unit, range);
  } catch (const Error& e) {
    Fail(e.what());
  }
  return value;
}

Duration ParameterFile::duration() const {
  const std::optional<Amount> amount = AmountOf(node_->yaml);
  if (amount && amount->unit == "Hz" && amount->number >= 1 && amount->number <= 1e9 &&
      amount->number == std::floor(amount->number))
    return Hertz(static_cast<std::int64_t>(amount->number));
  const double factor = amount ? FactorOf(amount->unit, "s") : 0;
  const double ns = amount ? std::round(1e9 * factor * amount->number) : 0;
  if (!amount || amount->unit.empty() || factor == 0 || !(ns >= 0) || ns > 9e18)
    Fail("expected a time such as 1 ms or a rate such as 30 Hz, got " + KindOf(node_->yaml));
  return Duration::Nanoseconds(static_cast<std::int64_t>(ns));
}

std::vector<ParameterFile> ParameterFile::elements() const {
  if (node_->yaml.IsNull()) return {};
  if (!node_->yaml.IsSequence()) Fail("expected a list, got " + KindOf(node_->yaml));
  std::vector<ParameterFile> all;
  for (const YAML::Node& element : node_->yaml) all.push_back(ParameterFile(node_->Inner(element)));
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
  if (!node_->yaml.IsScalar()) Fail("expected a word, got " + KindOf(node_->yaml));
  return node_->yaml.Scalar();
}

std::size_t ParameterFile::OneOf(const std::vector<std::string>& known) const {
  const std::string word = text();
  const auto found = std::ranges::find(known, word);
  if (found == known.end())
    Fail("expected one of " + Listed(known) + ", got '" + Short(word) + "'" +
         DidYouMean(Short(word), known));
  return static_cast<std::size_t>(found - known.begin());
}

std::vector<std::pair<std::string, ParameterFile>> ParameterFile::entries() const {
  if (node_->yaml.IsNull()) return {};
  if (!node_->yaml.IsMap()) Fail("expected a map, got " + KindOf(node_->yaml));
  std::vector<std::pair<std::string, ParameterFile>> all;
  for (const auto& entry : node_->yaml)
    all.emplace_back(entry.first.Scalar(), ParameterFile(node_->Inner(entry.second)));
  return all;
}

std::optional<ParameterFile> ParameterFile::Find(std::string_view key) const {
  for (auto& [name, value] : entries())
    if (name == key) return value;
  return {};
}

ParameterFile ParameterFile::operator[](std::string_view key) const {
  const std::optional<ParameterFile> found = Find(key);
  if (!found) Fail("'" + std::string(key) + "' is missing");
  return *found;
}

void ParameterFile::RequireKeys(const std::vector<std::string>& known) const {
  if (node_->yaml.IsNull()) return;
  if (!node_->yaml.IsMap()) Fail("expected a map, got " + KindOf(node_->yaml));
  for (const auto& entry : node_->yaml)
    if (const std::string& key = entry.first.Scalar(); std::ranges::find(known, key) == known.end())
      node_->Inner(entry.second)
          ->Fail(entry.first.Mark(), "there is no " + Quoted(key) + " here" +
                                         DidYouMean(Short(key), known) +
                                         "\n  known: " + Listed(known));
}

}  // namespace pliant
