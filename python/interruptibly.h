#pragma once

#include <pybind11/pybind11.h>

#include <atomic>
#include <chrono>
#include <future>

namespace pliant::python {

namespace py = pybind11;

/// Runs f in a thread of its own while this one, without the GIL, asks now and then for Ctrl-C.
template <class F>
auto Interruptibly(const F& f, std::atomic<bool>& stop) {
  auto result = std::async(std::launch::async, f);
  for (bool done = false; !done;) {
    {
      const py::gil_scoped_release release;
      done = result.wait_for(std::chrono::milliseconds(50)) == std::future_status::ready;
    }
    if (PyErr_CheckSignals()) {
      py::error_already_set interrupt;
      stop = true;
      {
        const py::gil_scoped_release release;
        result.wait();
      }
      throw interrupt;
    }
  }
  return result.get();
}

}  // namespace pliant::python
