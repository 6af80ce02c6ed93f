#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace pliant::internal {

/// A file that is written beside its place, as "<file>.part", and moved there when it is whole. An
/// older file stays as it is until then, and nothing half-written stays at all.
class PartFile {
 public:
  /// Throws Error, with the file and the reason, if it cannot be opened.
  explicit PartFile(std::filesystem::path file);
  ~PartFile();
  PartFile(const PartFile&) = delete;
  PartFile& operator=(const PartFile&) = delete;

  int descriptor() const { return descriptor_; }
  void Write(std::string_view bytes);
  void MoveIntoPlace();

 private:
  [[noreturn]] void Throw(int reason) const;

  const std::filesystem::path file_;
  std::filesystem::path part_;
  int descriptor_ = -1;
};

/// Throws Error if the file is there and is not to be written over, or is none, such as a device.
void RequireNewFile(const std::filesystem::path& file, bool force);

/// The whole of a file; throws Error, with the file and the reason, if it cannot be read.
std::string ReadFile(const std::filesystem::path& file);

void WriteFile(const std::filesystem::path& file, std::string_view bytes);

/// Makes the directory and those above it.
void MakeDirectory(const std::filesystem::path& directory);

}  // namespace pliant::internal
