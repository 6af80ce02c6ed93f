#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pliant/systems/parameter.h"

namespace pliant {

/// A place in a YAML file: a number, a word or a map. What is wrong there is an Error
/// "file:line:column: …".
class ParameterFile {
 public:
  /// The whole file. Refuses what is no YAML, keys given twice, keys that are no words, aliases
  /// that contain themselves, more than 32 maps and lists inside one another, a second document,
  /// and files that cannot be read.
  static ParameterFile Read(const std::filesystem::path& file);
  /// The same of a text; `source` stands for the file's name in messages.
  static ParameterFile ReadText(const std::string& text, const std::string& source = "YAML");

  double number() const;
  std::string text() const;
  /// One of `known`; its index.
  std::size_t OneOf(const std::vector<std::string>& known) const;

  /// The entries of a map in the order of the file; none if it is empty.
  std::vector<std::pair<std::string, ParameterFile>> entries() const;
  /// The value of a key, or nothing.
  std::optional<ParameterFile> Find(std::string_view key) const;
  /// The value of a key that must be there.
  ParameterFile operator[](std::string_view key) const;
  /// Refuses keys that are not among `known`, with the nearest of them.
  void RequireKeys(const std::vector<std::string>& known) const;

  /// Fills the parameters of `t` that the map gives, refuses other keys, numbers out of range, and
  /// parameters without a default that are not given.
  template <HasParameters T>
  void Fill(T& t) const;

  [[noreturn]] void Fail(const std::string& what) const;

 private:
  struct Node;
  explicit ParameterFile(std::shared_ptr<const Node> node) : node_{std::move(node)} {}

  void Assign(double& value, std::string_view name, std::string_view unit,
              const Range& range) const;
  void RequireGiven(double value, std::string_view name) const;

  std::shared_ptr<const Node> node_;
};

template <HasParameters T>
void ParameterFile::Fill(T& t) const {
  std::vector<std::string> known;
  t.Parameters([&](std::string_view name, auto&, std::string_view, const Range&) {
    known.emplace_back(name);
  });
  RequireKeys(known);
  t.Parameters([&](std::string_view name, auto& value, std::string_view unit, const Range& range) {
    if (const std::optional<ParameterFile> given = Find(name))
      given->Assign(value, name, unit, range);
    else if constexpr (std::same_as<std::decay_t<decltype(value)>, double>)
      RequireGiven(value, name);
  });
}

}  // namespace pliant
