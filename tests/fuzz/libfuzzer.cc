#include <cstddef>
#include <cstdint>

#include "pliant/tests/fuzz/targets.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  pliant::fuzz::PLIANT_FUZZ_TARGET({reinterpret_cast<const char*>(data), size});
  return 0;
}
