#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <Eigen/Core>
#include <string>
#include <vector>

namespace pliant::python {

namespace py = pybind11;
using namespace py::literals;

/// A copy, rows first.
py::array_t<double> MatrixArray(const Eigen::Ref<const Eigen::MatrixXd>& m);
py::array_t<double> VectorArray(const Eigen::Ref<const Eigen::VectorXd>& v);

inline constexpr Eigen::Index kAny = -1;
enum class May { BeFinite, BeInfinite };

/// The numbers of a list or an array. Throws Error "q: expected 7 numbers, got …" for another
/// shape, for what are no numbers, and for NaN.
Eigen::VectorXd VectorOf(const py::handle& from, const std::string& name, Eigen::Index size = kAny,
                         May may = May::BeFinite);
Eigen::MatrixXd MatrixOf(const py::handle& from, const std::string& name, Eigen::Index rows = kAny,
                         Eigen::Index cols = kAny);
double NumberOf(const py::handle& from, const std::string& name);

}  // namespace pliant::python
