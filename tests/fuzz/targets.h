#pragma once

#include <stdexcept>
#include <string>

#include "pliant/systems/error.h"

/// What is given any bytes, by a fuzzer or by tests/fuzz/corpus_test.cc. Bytes are refused by
/// Error; anything else that is thrown is a fault of pliant. True if something of them was read.
namespace pliant::fuzz {

bool Urdf(const std::string& bytes);
bool Actuators(const std::string& bytes);
bool KortexFrames(const std::string& bytes);
bool WrenchFrames(const std::string& bytes);
bool ScenarioFile(const std::string& bytes);
bool SweepFile(const std::string& bytes);
bool Mcap(const std::string& bytes);
bool Csv(const std::string& bytes);
bool Foxglove(const std::string& bytes);

inline void Check(bool holds, const char* what) {
  if (!holds) throw std::logic_error(what);
}

/// Whether `act` took what it was given.
template <class Act>
bool Takes(const Act& act) {
  try {
    act();
    return true;
  } catch (const Error&) {
    return false;
  }
}

}  // namespace pliant::fuzz
