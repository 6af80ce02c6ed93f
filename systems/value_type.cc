#include "pliant/systems/value_type.h"

#include <cxxabi.h>

#include <cstdlib>
#include <memory>

namespace pliant::internal {

std::string TypeName(const std::type_info& type) {
  int status = 0;
  const std::unique_ptr<char, void (*)(void*)> name(
      abi::__cxa_demangle(type.name(), nullptr, nullptr, &status), std::free);
  return status == 0 ? name.get() : type.name();
}

std::string UnitOf(std::string_view unit, Eigen::Index i, Eigen::Index n) {
  const std::size_t comma = unit.find(", ");
  if (comma == std::string_view::npos) return std::string(unit);
  return std::string(i < n / 2 ? unit.substr(0, comma) : unit.substr(comma + 2));
}

}  // namespace pliant::internal
