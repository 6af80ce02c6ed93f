#pragma once

#include <string>

#include "pliant/systems/error.h"

namespace pliant {

/// The message of the Error that `act` throws; "no error" if it throws none.
template <class Act>
std::string ErrorOf(const Act& act) {
  try {
    act();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

}  // namespace pliant
