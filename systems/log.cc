#include "pliant/systems/log.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <fstream>
#include <span>
#include <system_error>

#include "pliant/systems/nearest_name.h"

namespace pliant {

namespace {

std::string Quoted(const std::string& name) {
  return name.find(',') == std::string::npos ? name : '"' + name + '"';
}

}  // namespace

Log::Log(const std::vector<internal::Source>& sources, std::size_t capacity)
    : numbers_{sources}, capacity_{capacity} {
  for (const RecordedValue& value : numbers_.values())
    for (std::size_t i = 0; i < value.elements.size(); ++i)
      names_.push_back(value.path + value.elements[i] +
                       (value.units[i].empty() ? "" : " (" + value.units[i] + ")"));
  cells_.reserve(capacity_ * width());
}

Log::Log(const Log& other)
    : names_{other.names_}, numbers_{other.numbers_}, capacity_{other.capacity_} {
  cells_.reserve(std::max(capacity_ * width(), other.cells_.size()));
  cells_ = other.cells_;
}

Log& Log::operator=(const Log& other) {
  if (this == &other) return *this;
  names_ = other.names_;
  numbers_ = other.numbers_;
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
  cells_.resize(begin + width());
  cells_[begin] = t;
  numbers_.Store(values, std::span(cells_).subspan(begin + 1));
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
