#include "pliant/plants/parameter_file.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <fstream>
#include <iterator>

#include "pliant/systems/nearest_name.h"

namespace pliant {

namespace {

[[noreturn]] void FailAt(const std::string& source, const YAML::Mark& mark,
                         const std::string& what) {
  if (mark.is_null()) throw Error(source + ": " + what);
  throw Error(source + ":" + Text(mark.line + 1) + ":" + Text(mark.column + 1) + ": " + what);
}

std::string KindOf(const YAML::Node& node) {
  switch (node.Type()) {
    case YAML::NodeType::Map:
      return "a map";
    case YAML::NodeType::Sequence:
      return "a list";
    case YAML::NodeType::Scalar:
      return "'" + node.Scalar() + "'";
    default:
      return "nothing";
  }
}

std::string Listed(const std::vector<std::string>& names) {
  std::string list;
  for (const std::string& name : names) list += (list.empty() ? "" : ", ") + name;
  return list;
}

void RefuseRepeatedKeys(const YAML::Node& node, const std::string& source) {
  if (node.IsSequence())
    for (const YAML::Node& element : node) RefuseRepeatedKeys(element, source);
  if (!node.IsMap()) return;
  std::vector<std::string> seen;
  for (const auto& entry : node) {
    if (!entry.first.IsScalar()) FailAt(source, entry.first.Mark(), "a key must be a word");
    const std::string& key = entry.first.Scalar();
    if (std::ranges::find(seen, key) != seen.end())
      FailAt(source, entry.first.Mark(), "'" + key + "' is given twice");
    seen.push_back(key);
    RefuseRepeatedKeys(entry.second, source);
  }
}

}  // namespace

struct ParameterFile::Node {
  YAML::Node yaml;
  std::string source;
};

ParameterFile ParameterFile::Read(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  if (!in.is_open() || in.bad() || std::filesystem::is_directory(file))
    throw Error(file.string() + ": cannot be read");
  return ReadText(text, file.string());
}

ParameterFile ParameterFile::ReadText(const std::string& text, const std::string& source) try {
  const YAML::Node root = YAML::Load(text);
  RefuseRepeatedKeys(root, source);
  return ParameterFile(std::make_shared<const Node>(Node{root, source}));
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

bool ParameterFile::flag() const {
  bool value = false;
  if (!node_->yaml.IsScalar() || !YAML::convert<bool>::decode(node_->yaml, value))
    Fail("expected true or false, got " + KindOf(node_->yaml));
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
    Fail("expected one of " + Listed(known) + ", got '" + word + "'" + DidYouMean(word, known));
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
             "there is no '" + key + "' here" + DidYouMean(key, known) +
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
