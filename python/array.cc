#include "pliant/python/array.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "pliant/analysis/printable.h"
#include "pliant/systems/error.h"

namespace pliant::python {

namespace {

using Numbers = py::array_t<double, py::array::c_style | py::array::forcecast>;

std::string ShapeText(const py::array& array) { return py::str(array.attr("shape")); }

/// What Python says of it, kept short.
std::string Shown(const py::handle& from) {
  std::string text = py::repr(from);
  if (text.size() > 60) text = FirstBytes(text, 60) + "…";
  return std::string(py::str(py::type::handle_of(from).attr("__name__"))) + " " + text;
}

Numbers NumbersOf(const py::handle& from, const std::string& name, const std::string& expected,
                  May may) {
  const auto refuse = [&](const std::string& found) {
    throw Error(name + ": expected " + expected + ", got " + found);
  };
  py::array array;
  try {
    array = py::array(py::reinterpret_borrow<py::object>(from));
  } catch (py::error_already_set&) {
    refuse(Shown(from));
  }
  if (std::string("iuf").find(array.dtype().kind()) == std::string::npos && array.size() > 0)
    refuse(py::isinstance<py::array>(from)
               ? "an array of dtype " + std::string(py::str(array.dtype()))
               : Shown(from));
  const Numbers numbers(array);
  const double* const bad = std::find_if_not(
      numbers.data(), numbers.data() + numbers.size(),
      [&](double x) { return may == May::BeFinite ? std::isfinite(x) : !std::isnan(x); });
  if (bad != numbers.data() + numbers.size())
    refuse((std::isnan(*bad) ? "nan" : Text(*bad)) + " at index " +
           std::to_string(bad - numbers.data()));
  return numbers;
}

std::string Sized(Eigen::Index n) { return n == kAny ? "any number" : std::to_string(n); }

}  // namespace

py::array_t<double> MatrixArray(const Eigen::Ref<const Eigen::MatrixXd>& m) {
  py::array_t<double> array({m.rows(), m.cols()});
  auto at = array.mutable_unchecked<2>();
  for (Eigen::Index i = 0; i < m.rows(); ++i)
    for (Eigen::Index j = 0; j < m.cols(); ++j) at(i, j) = m(i, j);
  return array;
}

py::array_t<double> VectorArray(const Eigen::Ref<const Eigen::VectorXd>& v) {
  return py::array_t<double>(v.size(), v.data());
}

Eigen::VectorXd VectorOf(const py::handle& from, const std::string& name, Eigen::Index size,
                         May may) {
  const std::string expected =
      (size == kAny ? "" : Text(size) + " ") +
      (may == May::BeFinite ? "finite numbers" : "numbers, which may be infinite");
  const Numbers numbers = NumbersOf(from, name, expected, may);
  if (numbers.ndim() != 1 || (size != kAny && numbers.size() != size))
    throw Error(name + ": expected " + expected + ", got shape " + ShapeText(numbers));
  return Eigen::VectorXd::Map(numbers.data(), numbers.size());
}

Eigen::MatrixXd MatrixOf(const py::handle& from, const std::string& name, Eigen::Index rows,
                         Eigen::Index cols) {
  const std::string expected =
      rows == kAny && cols == kAny
          ? "a matrix of finite numbers"
          : "a matrix of " + Sized(rows) + " by " + Sized(cols) + " finite numbers";
  const Numbers numbers = NumbersOf(from, name, expected, May::BeFinite);
  if (numbers.ndim() != 2 || (rows != kAny && numbers.shape(0) != rows) ||
      (cols != kAny && numbers.shape(1) != cols))
    throw Error(name + ": expected " + expected + ", got shape " + ShapeText(numbers));
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  return RowMajor::Map(numbers.data(), numbers.shape(0), numbers.shape(1));
}

double NumberOf(const py::handle& from, const std::string& name) {
  const Numbers number = NumbersOf(from, name, "a finite number", May::BeFinite);
  if (number.ndim() != 0)
    throw Error(name + ": expected a finite number, got shape " + ShapeText(number));
  return *number.data();
}

}  // namespace pliant::python
