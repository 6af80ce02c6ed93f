#include "pliant/systems/log.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <fstream>
#include <limits>
#include <system_error>

#include "pliant/systems/nearest_name.h"

namespace pliant {

namespace {

std::string Quoted(const std::string& name) {
  return name.find(',') == std::string::npos ? name : '"' + name + '"';
}

}  // namespace

Log::Log(const std::vector<internal::Source>& sources, std::size_t capacity) : capacity_{capacity} {
  for (const internal::Source& source : sources) {
    if (!source.type->write)
      throw Error("cannot log " + source.path + " : " + source.type->name +
                  ", which is not made of numbers\ngive its type a function template Fields");
    std::vector<internal::Column> columns;
    source.type->columns(source.initial, source.space, columns);
    if (columns.empty())
      throw Error("cannot log " + source.path + " : " + source.type->name +
                  ", which has no elements yet\ngive its port a space or an initial value");
    widths_.push_back(columns.size());
    for (const internal::Column& column : columns)
      names_.push_back(source.path + column.name +
                       (column.unit.empty() ? "" : " (" + column.unit + ")"));
  }
  cells_.reserve(capacity_ * width());
}

Log::Log(const Log& other)
    : names_{other.names_}, widths_{other.widths_}, capacity_{other.capacity_} {
  cells_.reserve(std::max(capacity_ * width(), other.cells_.size()));
  cells_ = other.cells_;
}

Log& Log::operator=(const Log& other) {
  if (this == &other) return *this;
  names_ = other.names_;
  widths_ = other.widths_;
  capacity_ = other.capacity_;
  cells_.reserve(capacity_ * width());
  cells_ = other.cells_;
  return *this;
}

Log::Column Log::At(std::size_t column) const {
  return {cells_.data() + column, static_cast<Eigen::Index>(rows()),
          Eigen::InnerStride<>(static_cast<Eigen::Index>(width()))};
}

Log::Column Log::operator[](std::string_view column) const {
  const auto is_it = [&](const std::string& name) {
    return name == column || std::string_view(name).substr(0, name.find(" (")) == column;
  };
  const auto at = std::ranges::find_if(names_, is_it);
  if (at == names_.end())
    throw Error("the log has no column '" + std::string(column) + "'" + DidYouMean(column, names_));
  return At(static_cast<std::size_t>(at - names_.begin()) + 1);
}

void Log::Record(double t, const AnyValues& values) {
  while (!cells_.empty() && cells_[cells_.size() - width()] >= t)
    cells_.resize(cells_.size() - width());
  const std::size_t begin = cells_.size();
  cells_.resize(begin + width(), std::numeric_limits<double>::quiet_NaN());
  double* cell = cells_.data() + begin;
  *cell++ = t;
  for (int i = 0; i < values.size(); ++i) {
    const std::size_t n = widths_[static_cast<std::size_t>(i)];
    if (values.type(i).count(values[i]) == n) values.type(i).store(values[i], cell);
    cell += n;
  }
}

void Log::WriteCsv(const std::filesystem::path& file) const {
  std::filesystem::path part = file;
  part += ".part";
  errno = 0;
  std::ofstream out(part, std::ios::trunc);
  out << "time (s)";
  for (const std::string& name : names_) out << ',' << Quoted(name);
  std::array<char, 32> text;
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    out << (i % width() == 0 ? '\n' : ',');
    const auto end = std::to_chars(text.data(), text.data() + text.size(), cells_[i]).ptr;
    out.write(text.data(), end - text.data());
  }
  out << '\n';
  out.close();
  std::error_code error;
  if (out) std::filesystem::rename(part, file, error);
  if (!out || error) {
    const std::string reason = error ? error.message() : std::strerror(errno);
    std::filesystem::remove(part, error);
    throw Error("cannot write the log " + file.string() + ": " + reason);
  }
}

}  // namespace pliant
