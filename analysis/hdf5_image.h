#pragma once

#include <hdf5.h>

#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace pliant::internal {

/// What the library gives, unless it failed; then throws Error with its reason.
hid_t Checked(hid_t id);

/// A thing of the library that is closed with its end.
class Handle {
 public:
  Handle(hid_t id, herr_t (*close)(hid_t)) : id_{Checked(id)}, close_{close} {}
  ~Handle() { close_(id_); }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;

  operator hid_t() const { return id_; }

 private:
  const hid_t id_;
  herr_t (*const close_)(hid_t);
};

/// An array of words, or a single one if it is `scalar`.
void WriteWords(hid_t where, const std::string& name, const std::vector<std::string>& words,
                bool scalar = false);
void WriteWord(hid_t where, const std::string& name, const std::string& word);

/// Rows of `columns` numbers; a vector if it is 0.
void WriteNumbers(hid_t where, const char* name, const double* numbers, hsize_t rows,
                  hsize_t columns, std::string_view unit);

/// A group and those above it, the parts of its name between dots or slashes.
Handle MakeGroup(hid_t file, const std::string& name);

/// The bytes of a file that `write` fills. They are made in memory: the library does not get over a
/// full disk. Throws Error with its reason.
std::string Hdf5Image(const std::function<void(hid_t file)>& write);

}  // namespace pliant::internal
