#include "pliant/plants/parameter_file.h"

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <fstream>
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

/// The text of a file, or nothing where it cannot be read to its end.
std::optional<std::string> ContentOf(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::string text;
  for (char c = 0; in.get(c);) text += c;
  if (!in.is_open() || in.bad()) return {};
  return text;
}

}  // namespace

struct ParameterFile::Node {
  YAML::Node yaml;
  std::string source;
};

ParameterFile ParameterFile::Read(const std::filesystem::path& file) {
  const std::optional<std::string> text = ContentOf(file);
  if (!text) throw Error(file.string() + ": cannot be read");
  return ReadText(*text, file.string());
}

ParameterFile ParameterFile::ReadText(const std::string& text, const std::string& source) try {
  std::istringstream in(text);
  YAML::Parser parser(in);
  Check check(source);
  while (parser.HandleNextDocument(check)) {
  }
  return ParameterFile(std::make_shared<const Node>(Node{YAML::Load(text), source}));
} catch (const YAML::Exception& e) {
  FailAt(source, e.mark, e.msg);
}

void ParameterFile::Fail(const std::string& what) const {
  FailAt(node_->source, node_->yaml.Mark(), what);
}

double ParameterFile::number() const {
  double value = 0;
  if (!node_->yaml.IsScalar() || !YAML::convert<double>::decode(node_->yaml, value))
    Fail("expected a number, got " + KindOf(node_->yaml));
  return value;
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
    all.emplace_back(
        entry.first.Scalar(),
        ParameterFile(std::make_shared<const Node>(Node{entry.second, node_->source})));
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
      FailAt(node_->source, entry.first.Mark(),
             "there is no " + Quoted(key) + " here" + DidYouMean(Short(key), known) +
                 "\n  known: " + Listed(known));
}

void ParameterFile::Assign(double& value, std::string_view name, std::string_view unit,
                           const Range& range) const {
  value = number();
  try {
    RequireInRange("", name, value, unit, range);
  } catch (const Error& e) {
    Fail(e.what());
  }
}

void ParameterFile::RequireGiven(double value, std::string_view name) const {
  if (std::isnan(value)) Fail("'" + std::string(name) + "' is missing");
}

}  // namespace pliant
