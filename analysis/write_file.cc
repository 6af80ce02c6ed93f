#include "pliant/analysis/write_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>
#include <string>
#include <system_error>
#include <utility>

#include "pliant/systems/error.h"

namespace pliant::internal {

PartFile::PartFile(std::filesystem::path file) : file_{std::move(file)}, part_{file_} {
  part_ += ".part";
  descriptor_ = open(part_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (descriptor_ < 0) Throw(errno);
}

PartFile::~PartFile() {
  if (descriptor_ >= 0) close(descriptor_);
  if (!part_.empty()) unlink(part_.c_str());
}

void PartFile::Write(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = write(descriptor_, bytes.data(), bytes.size());
    if (written >= 0) {
      bytes.remove_prefix(static_cast<std::size_t>(written));
    } else if (errno != EINTR) {
      Throw(errno);
    }
  }
}

void PartFile::MoveIntoPlace() {
  // A full disk may show only when the file is closed.
  if (close(std::exchange(descriptor_, -1)) != 0) Throw(errno);
  std::error_code error;
  std::filesystem::rename(part_, file_, error);
  if (error) Throw(error.value());
  part_.clear();
}

void PartFile::Throw(int reason) const {
  throw Error("cannot write " + file_.string() + ": " + std::strerror(reason));
}

void RequireNewFile(const std::filesystem::path& file, bool force) {
  std::error_code ignored;
  const std::filesystem::file_status status = std::filesystem::status(file, ignored);
  if (!std::filesystem::exists(status)) return;
  if (!std::filesystem::is_regular_file(status))
    throw Error("cannot write " + file.string() + ": it is there and not a file");
  if (!force)
    throw Error(file.string() + " exists; give --force to write over it, or another place");
}

std::string ReadFile(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream content;
  errno = 0;
  if (in && in.peek() != std::ifstream::traits_type::eof()) content << in.rdbuf();
  if (!in || !content) throw Error("cannot read " + file.string() + ": " + std::strerror(errno));
  return content.str();
}

void WriteFile(const std::filesystem::path& file, std::string_view bytes) {
  PartFile part(file);
  part.Write(bytes);
  part.MoveIntoPlace();
}

void MakeDirectory(const std::filesystem::path& directory) {
  std::error_code error;
  std::filesystem::create_directories(directory, error);
  if (error)
    throw Error("cannot make the directory " + directory.string() + ": " + error.message());
}

}  // namespace pliant::internal
