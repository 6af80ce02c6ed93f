#pragma once

#include <algorithm>
#include <array>
#include <concepts>
#include <cstring>
#include <new>
#include <string>
#include <string_view>
#include <type_traits>
#include <typeinfo>
#include <vector>

#include "pliant/systems/signal.h"
#include "pliant/systems/words.h"

namespace pliant::internal {

/// A number inside a value, as a column of a log: `[element]` or `.field[element]`, and its unit.
struct Column {
  std::string name;
  std::string unit;
};

/// What the kernel must know of a type to keep its values in an arena: one description, from which
/// copies, comparisons, snapshots, logs and linearisation follow.
struct ValueType {
  std::size_t size;
  std::size_t alignment;
  std::string name;  ///< the quantity, or the C++ type
  std::string unit;

  void (*construct)(void* at, const void* from);
  void (*assign)(void* to, const void* from);
  void (*destroy)(void* at);

  /// Bytes that restore the value exactly; null where the type has no `Fields` and is no number,
  /// vector, matrix or array of such.
  void (*write)(const void* value, std::string& bytes);
  /// Reads what `write` wrote; returns the end of it, or null if the bytes do not fit.
  const char* (*read)(void* value, const char* begin, const char* end);
  /// Bit for bit; null where the type can neither be written nor compared with ==.
  bool (*equal)(const void* a, const void* b);

  /// The numbers of a value in order; null together with `write`.
  void (*numbers)(const void* value, std::vector<double>& out);
  const double* (*set_numbers)(void* value, const double* from);
  void (*columns)(const void* value, const pliant::Space& space, std::vector<Column>& out);
  /// Writes the numbers of a value that has `count` of them; false, and nothing written, if it has
  /// another number of them.
  bool (*store)(const void* value, double* to, std::size_t count);
  std::size_t (*count)(const void* value);  ///< of its numbers

  /// Of an enumeration that has a word for each value; null of any other type.
  const std::vector<std::string>& (*words)();
};

template <class T>
concept Number = std::is_arithmetic_v<T> || std::is_enum_v<T>;

template <class T>
concept Dense = requires(T& t) {
  typename T::PlainObject;
  { t.data() } -> std::convertible_to<const double*>;
  t.rows();
  t.cols();
};

struct AnyVisitor {
  template <class T>
  void operator()(std::string_view, T&, std::string_view) const {}
};
template <class T>
concept HasFields = requires(T& t) {
  t.Fields(AnyVisitor{});
};

template <class T>
struct IsArray : std::false_type {};
template <class T, std::size_t N>
struct IsArray<std::array<T, N>> : std::true_type {};

template <class T>
constexpr bool CanWrite() {
  if constexpr (Number<T> || Dense<T>) {
    return true;
  } else if constexpr (IsArray<T>::value) {
    return CanWrite<typename T::value_type>();
  } else {
    return HasFields<T>;
  }
}

template <class T>
void Write(const T& value, std::string& bytes) {
  if constexpr (Number<T>) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof(T));
  } else if constexpr (Dense<T>) {
    const std::int32_t shape[2] = {static_cast<std::int32_t>(value.rows()),
                                   static_cast<std::int32_t>(value.cols())};
    bytes.append(reinterpret_cast<const char*>(shape), sizeof(shape));
    for (Eigen::Index c = 0; c < value.cols(); ++c)
      for (Eigen::Index r = 0; r < value.rows(); ++r) {
        const double x = value(r, c);
        bytes.append(reinterpret_cast<const char*>(&x), sizeof(x));
      }
  } else if constexpr (IsArray<T>::value) {
    for (const auto& element : value) Write(element, bytes);
  } else {
    static_assert(HasFields<T>,
                  "Fields names numbers, Eigen vectors and matrices, arrays and structs of such");
    const_cast<T&>(value).Fields(
        [&](std::string_view, const auto& field, std::string_view) { Write(field, bytes); });
  }
}

template <class T>
const char* Read(T& value, const char* p, const char* end) {
  if constexpr (Number<T>) {
    if (!p || end - p < static_cast<std::ptrdiff_t>(sizeof(T))) return nullptr;
    std::memcpy(&value, p, sizeof(T));
    return p + sizeof(T);
  } else if constexpr (Dense<T>) {
    std::int32_t shape[2];
    if (!p || end - p < static_cast<std::ptrdiff_t>(sizeof(shape))) return nullptr;
    std::memcpy(shape, p, sizeof(shape));
    p += sizeof(shape);
    if (shape[0] != value.rows() || shape[1] != value.cols()) return nullptr;
    if (end - p < static_cast<std::ptrdiff_t>(sizeof(double)) * value.size()) return nullptr;
    for (Eigen::Index c = 0; c < value.cols(); ++c)
      for (Eigen::Index r = 0; r < value.rows(); ++r, p += sizeof(double))
        std::memcpy(&value(r, c), p, sizeof(double));
    return p;
  } else if constexpr (IsArray<T>::value) {
    for (auto& element : value) p = Read(element, p, end);
    return p;
  } else {
    value.Fields([&](std::string_view, auto& field, std::string_view) { p = Read(field, p, end); });
    return p;
  }
}

template <class T>
void Numbers(const T& value, std::vector<double>& out) {
  if constexpr (Number<T>) {
    out.push_back(static_cast<double>(value));
  } else if constexpr (Dense<T>) {
    for (Eigen::Index c = 0; c < value.cols(); ++c)
      for (Eigen::Index r = 0; r < value.rows(); ++r) out.push_back(value(r, c));
  } else if constexpr (IsArray<T>::value) {
    for (const auto& element : value) Numbers(element, out);
  } else {
    const_cast<T&>(value).Fields(
        [&](std::string_view, const auto& field, std::string_view) { Numbers(field, out); });
  }
}

template <class T>
std::size_t Count(const T& value) {
  if constexpr (Number<T>) {
    return 1;
  } else if constexpr (Dense<T>) {
    return static_cast<std::size_t>(value.size());
  } else {
    std::size_t n = 0;
    if constexpr (IsArray<T>::value) {
      for (const auto& element : value) n += Count(element);
    } else {
      const_cast<T&>(value).Fields(
          [&](std::string_view, const auto& field, std::string_view) { n += Count(field); });
    }
    return n;
  }
}

template <class T>
double* Store(const T& value, double* to) {
  if constexpr (Number<T>) {
    *to++ = static_cast<double>(value);
  } else if constexpr (Dense<T>) {
    static_assert(!T::IsRowMajor || T::RowsAtCompileTime == 1, "numbers stand column by column");
    to = std::copy_n(value.data(), value.size(), to);
  } else if constexpr (IsArray<T>::value) {
    for (const auto& element : value) to = Store(element, to);
  } else {
    const_cast<T&>(value).Fields(
        [&](std::string_view, const auto& field, std::string_view) { to = Store(field, to); });
  }
  return to;
}

template <class T>
const double* SetNumbers(T& value, const double* from) {
  if constexpr (Number<T>) {
    value = static_cast<T>(*from++);
  } else if constexpr (Dense<T>) {
    for (Eigen::Index c = 0; c < value.cols(); ++c)
      for (Eigen::Index r = 0; r < value.rows(); ++r) value(r, c) = *from++;
  } else if constexpr (IsArray<T>::value) {
    for (auto& element : value) from = SetNumbers(element, from);
  } else {
    value.Fields(
        [&](std::string_view, auto& field, std::string_view) { from = SetNumbers(field, from); });
  }
  return from;
}

/// Unit of element i of n: a spatial vector names two, "rad/s, m/s".
std::string UnitOf(std::string_view unit, Eigen::Index i, Eigen::Index n);

template <class T>
void Columns(const T& value, const pliant::Space& space, const std::string& prefix,
             std::string_view unit, std::vector<Column>& out) {
  if constexpr (Number<T>) {
    out.push_back({prefix, std::string(unit)});
  } else if constexpr (Dense<T>) {
    const Eigen::Index n = value.size();
    for (Eigen::Index c = 0; c < value.cols(); ++c)
      for (Eigen::Index r = 0; r < value.rows(); ++r) {
        const Eigen::Index i = c * value.rows() + r;
        std::string element = std::to_string(i);
        if constexpr (requires { T::elements; }) {
          element = T::elements[static_cast<std::size_t>(i)];
        } else if (value.cols() > 1) {
          element = std::to_string(r) + "," + std::to_string(c);
        } else if (n == space.size()) {
          element = space[static_cast<int>(i)];
        } else if (n == 3) {
          element = std::string(1, "xyz"[i]);
        }
        out.push_back({prefix + "[" + element + "]", UnitOf(unit, i, n)});
      }
  } else if constexpr (IsArray<T>::value) {
    for (std::size_t i = 0; i < value.size(); ++i)
      Columns(value[i], space, prefix + "[" + std::to_string(i) + "]", unit, out);
  } else {
    const_cast<T&>(value).Fields([&](std::string_view name, const auto& f, std::string_view u) {
      Columns(f, space, prefix + "." + std::string(name), u, out);
    });
  }
}

std::string TypeName(const std::type_info& type);

template <class T>
ValueType DescribeType() {
  ValueType type{};
  type.size = sizeof(T);
  type.alignment = alignof(T);
  if constexpr (requires { T::quantity; }) {
    type.name = T::quantity.name;
    type.unit = T::quantity.unit;
  } else if constexpr (std::is_same_v<T, PerJoint>) {
    type.name = "number per joint";
  } else if constexpr (Dense<T>) {
    type.name = T::ColsAtCompileTime == 1 ? "vector" : "matrix";
  } else {
    type.name = TypeName(typeid(T));
  }
  if constexpr (HasWords<T>)
    type.words = []() -> const std::vector<std::string>& { return Words(T{}); };
  type.construct = [](void* at, const void* from) { new (at) T(*static_cast<const T*>(from)); };
  type.assign = [](void* to, const void* from) {
    *static_cast<T*>(to) = *static_cast<const T*>(from);
  };
  type.destroy = [](void* at) { static_cast<T*>(at)->~T(); };
  if constexpr (CanWrite<T>()) {
    type.write = [](const void* v, std::string& bytes) { Write(*static_cast<const T*>(v), bytes); };
    type.read = [](void* v, const char* p, const char* end) {
      return Read(*static_cast<T*>(v), p, end);
    };
    type.equal = [](const void* a, const void* b) {
      std::string left, right;
      Write(*static_cast<const T*>(a), left);
      Write(*static_cast<const T*>(b), right);
      return left == right;
    };
    type.numbers = [](const void* v, std::vector<double>& out) {
      Numbers(*static_cast<const T*>(v), out);
    };
    type.set_numbers = [](void* v, const double* from) {
      return SetNumbers(*static_cast<T*>(v), from);
    };
    type.columns = [](const void* v, const pliant::Space& space, std::vector<Column>& out) {
      std::string_view unit;
      if constexpr (requires { T::quantity; }) unit = T::quantity.unit;
      Columns(*static_cast<const T*>(v), space, "", unit, out);
    };
    type.store = [](const void* v, double* to, std::size_t count) {
      const T& value = *static_cast<const T*>(v);
      if (Count(value) != count) return false;
      Store(value, to);
      return true;
    };
    type.count = [](const void* v) { return Count(*static_cast<const T*>(v)); };
  } else if constexpr (std::equality_comparable<T>) {
    type.equal = [](const void* a, const void* b) {
      return *static_cast<const T*>(a) == *static_cast<const T*>(b);
    };
  }
  return type;
}

/// The one description of T; its address identifies the type.
template <class T>
const ValueType* TypeOf() {
  static_assert(std::is_copy_constructible_v<T> && std::is_copy_assignable_v<T>,
                "a signal is a copyable type");
  static const ValueType type = DescribeType<T>();
  return &type;
}

template <class S>
struct SpaceOf {
  using type = Nothing;
};
template <class S>
requires requires { typename S::Space; }
struct SpaceOf<S> {
  using type = typename S::Space;
};
template <>
struct SpaceOf<PerJoint> {
  using type = Joints;
};

template <class S, class Sp>
S ZeroOf(const Sp& space) {
  if constexpr (requires { S::Zero(space); }) {
    return S::Zero(space);
  } else if constexpr (std::is_same_v<S, PerJoint>) {
    return PerJoint::Zero(space.size());
  } else if constexpr (Dense<S>) {
    S zero;
    zero.setZero();
    return zero;
  } else {
    return S{};
  }
}

}  // namespace pliant::internal
