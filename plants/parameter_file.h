#pragma once

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "pliant/systems/parameter.h"
#include "pliant/systems/time.h"
#include "pliant/systems/value_type.h"

namespace pliant {

/// Values that stand in for those of a file: "controller.pose.stiffness" and "200 N/m".
using Overrides = std::vector<std::pair<std::string, std::string>>;

/// A place in a YAML file: a number, a word, a list or a map. What is wrong there is an Error
/// "file:line:column: …".
class ParameterFile {
 public:
  /// The whole file. Refuses what is no YAML, keys given twice, keys that are no words, aliases
  /// that contain themselves, more than 32 maps and lists inside one another, more than
  /// 100 000 values (those of an alias count wherever it stands), a second document, files that
  /// cannot be read, and files of more than 512 KiB.
  static ParameterFile Read(const std::filesystem::path& file);
  /// What ReadText takes, of a file.
  static std::string TextOf(const std::filesystem::path& file);
  /// The same of a text; `source` stands for the file's name in messages.
  static ParameterFile ReadText(const std::string& text, const std::string& source = "YAML");

  /// Puts YAML in the place of the value at `path`, keys and indices from 0 with dots between
  /// them; what is not there is made. Other users of an alias keep what they have. What is wrong
  /// with it is an Error "<source>: …".
  void Set(const std::string& path, const std::string& yaml, const std::string& source);

  double number() const;
  std::string text() const;
  /// The place as YAML in one line, which reads back the same. Throws Error if that is longer than
  /// a file may be.
  std::string yaml() const;
  /// What it is said to be: "Push" of `!Push {…}`; empty if nothing is said.
  std::string tag() const;
  /// One of `known`; its index.
  std::size_t OneOf(const std::vector<std::string>& known) const;

  /// The elements of a list.
  std::vector<ParameterFile> elements() const;
  /// The entries of a map in the order of the file; none if it is empty.
  std::vector<std::pair<std::string, ParameterFile>> entries() const;
  /// The value of a key, or nothing.
  std::optional<ParameterFile> Find(std::string_view key) const;
  /// The value of a key that must be there.
  ParameterFile operator[](std::string_view key) const;
  /// Refuses keys that are not among `known`, with the nearest of them.
  void RequireKeys(const std::vector<std::string>& known) const;

  /// Fills the parameters of `t` that the map gives, refuses other keys, numbers out of range,
  /// units of another quantity, and parameters that are to be given and are not.
  ///
  /// A number may have its unit behind it, or a multiple of it: `0.5 s`, `500 ms`, `90 deg`. The
  /// alternative of a variant stands as a tag: `!Push {link: tool, …}`. A matrix is a list of rows;
  /// for one of any size a number stands for one row and column, a list of numbers for a column.
  template <HasParameters T>
  void Fill(T& t) const;

  /// The same of any parameter by itself; `name` stands in messages.
  template <class T>
  void Read(T& value, std::string_view name = {}, std::string_view unit = {},
            const Range& range = kAnyNumber) const;

  [[noreturn]] void Fail(const std::string& what) const;

 private:
  struct Node;
  class Reader;
  explicit ParameterFile(std::shared_ptr<const Node> node) : node_{std::move(node)} {}

  [[noreturn]] void FailTag(const std::vector<std::string>& known) const;
  bool IsNull() const;
  bool IsList() const;
  bool flag() const;
  double NumberIn(std::string_view name, std::string_view unit, const Range& range) const;
  Duration duration() const;
  std::vector<ParameterFile> ElementsOf(std::ptrdiff_t fixed, std::ptrdiff_t most) const;
  template <class Matrix>
  void ReadDense(Matrix& value, std::string_view name, std::string_view unit,
                 const Range& range) const;
  template <class... T>
  void ReadVariant(std::variant<T...>& value) const;

  std::shared_ptr<const Node> node_;
};

namespace internal {

template <class T>
constexpr bool IsOptional = false;
template <class T>
constexpr bool IsOptional<std::optional<T>> = true;
template <class T>
constexpr bool IsList = false;
template <class T>
constexpr bool IsList<std::vector<T>> = true;
template <class T>
constexpr bool IsVariant = false;
template <class... T>
constexpr bool IsVariant<std::variant<T...>> = true;

template <class T>
constexpr bool IsOfAnySize = false;
template <Dense T>
constexpr bool IsOfAnySize<T> =
    T::RowsAtCompileTime == Eigen::Dynamic&& T::ColsAtCompileTime == Eigen::Dynamic;

/// Whether a parameter, or one inside it, holds what says that it is to be given.
template <class T>
bool IsToBeGiven(const T& value) {
  if constexpr (std::is_same_v<T, double>) {
    return value != value;
  } else if constexpr (Dense<T>) {
    return value.size() > 0 && value.hasNaN();
  } else if constexpr (std::is_same_v<T, std::string>) {
    return value.empty();
  } else if constexpr (IsVariant<T>) {
    return std::visit([](const auto& of) { return IsToBeGiven(of); }, value);
  } else if constexpr (HasParameters<T>) {
    bool to_be_given = false;
    const_cast<T&>(value).Parameters(
        [&](std::string_view, auto& inner, std::string_view = {}, const Range& = kAnyNumber) {
          to_be_given = to_be_given || IsToBeGiven(inner);
        });
    return to_be_given;
  } else {
    return false;
  }
}

}  // namespace internal

template <HasParameters T>
void ParameterFile::Fill(T& t) const {
  std::vector<std::string> known;
  t.Parameters([&](std::string_view name, auto&, std::string_view = {}, const Range& = kAnyNumber) {
    known.emplace_back(name);
  });
  RequireKeys(known);
  t.Parameters([&](std::string_view name, auto& value, std::string_view unit = {},
                   const Range& range = kAnyNumber) {
    if (const std::optional<ParameterFile> given = Find(name))
      given->Read(value, name, unit, range);
    else if (internal::IsToBeGiven(value))
      Fail("'" + std::string(name) + "' is missing");
  });
}

template <class T>
void ParameterFile::Read(T& value, std::string_view name, std::string_view unit,
                         const Range& range) const {
  if constexpr (std::is_same_v<T, Overrides>) {
    value.clear();
    for (const auto& [path, place] : entries()) value.emplace_back(path, place.yaml());
  } else if constexpr (std::is_same_v<T, bool>) {
    value = flag();
  } else if constexpr (std::is_integral_v<T>) {
    const double number = NumberIn(name, unit, range);
    constexpr T kLeast = std::numeric_limits<T>::min(), kMost = std::numeric_limits<T>::max();
    // The greatest T may be no double; what lies above it by one always is.
    constexpr double kAbove = 2.0 * static_cast<double>(kMost / 2 + 1);
    if (!(number >= static_cast<double>(kLeast) && number < kAbove && number == std::floor(number)))
      Fail("expected a whole number from " + Text(kLeast) + " to " + Text(kMost) + ", got " +
           text());
    value = static_cast<T>(number);
  } else if constexpr (std::is_floating_point_v<T>) {
    value = NumberIn(name, unit, range);
  } else if constexpr (std::is_same_v<T, std::string>) {
    value = text();
    if (value.empty()) Fail("'" + std::string(name) + "' says nothing");
  } else if constexpr (std::is_same_v<T, Duration>) {
    value = duration();
  } else if constexpr (HasWords<T>) {
    value = static_cast<T>(OneOf(Words(T{})));
  } else if constexpr (internal::Dense<T>) {
    ReadDense(value, name, unit, range);
  } else if constexpr (internal::IsOptional<T>) {
    value.reset();
    if (!IsNull()) Read(value.emplace(), name, unit, range);
  } else if constexpr (internal::IsList<T>) {
    value.clear();
    for (const ParameterFile& element : elements()) {
      typename T::value_type one{};
      element.Read(one, name, unit, range);
      value.push_back(std::move(one));
    }
  } else if constexpr (internal::IsVariant<T>) {
    ReadVariant(value);
  } else {
    static_assert(HasParameters<T>, "a parameter is of one of the kinds HasParameters names");
    Fill(value);
  }
}

template <class Matrix>
void ParameterFile::ReadDense(Matrix& value, std::string_view name, std::string_view unit,
                              const Range& range) const {
  const auto number = [&](const ParameterFile& place) { return place.NumberIn(name, unit, range); };
  constexpr bool kAnySize = internal::IsOfAnySize<Matrix>;
  if constexpr (kAnySize) {
    if (!IsNull() && !IsList()) {
      value = Matrix::Constant(1, 1, number(*this));
      return;
    }
  }
  const std::vector<ParameterFile> rows =
      ElementsOf(Matrix::RowsAtCompileTime, Matrix::MaxRowsAtCompileTime);
  const bool column =
      Matrix::ColsAtCompileTime == 1 || (kAnySize && !rows.empty() && !rows[0].IsList());
  std::ptrdiff_t columns = column ? 1 : Matrix::ColsAtCompileTime;
  if (kAnySize && !column)
    columns = rows.empty()
                  ? 0
                  : std::ssize(rows[0].ElementsOf(Eigen::Dynamic, Matrix::MaxColsAtCompileTime));
  if constexpr (Matrix::RowsAtCompileTime == Eigen::Dynamic)
    value.resize(static_cast<Eigen::Index>(rows.size()), columns);
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const auto i = static_cast<Eigen::Index>(r);
    if (column) {
      value(i, 0) = number(rows[r]);
    } else {
      const std::vector<ParameterFile> row = rows[r].ElementsOf(columns, 0);
      for (std::size_t c = 0; c < row.size(); ++c)
        value(i, static_cast<Eigen::Index>(c)) = number(row[c]);
    }
  }
}

template <class... T>
void ParameterFile::ReadVariant(std::variant<T...>& value) const {
  static const std::vector<std::string> known{T::kTag...};
  const std::string given = tag();
  const bool found = ((given == T::kTag && (Fill(value.template emplace<T>()), true)) || ...);
  if (!found) FailTag(known);
}

}  // namespace pliant
