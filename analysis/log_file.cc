#include "pliant/analysis/log_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string>
#include <system_error>
#include <utility>

#include "pliant/systems/error.h"

namespace pliant::internal {
namespace {

/// Where a link leads, so that it stays a link.
std::filesystem::path Resolved(const std::filesystem::path& file) {
  std::error_code error;
  const std::filesystem::path target = std::filesystem::canonical(file, error);
  return error ? file : target;
}

}  // namespace

LogFile::LogFile(const std::filesystem::path& file, bool force)
    : path_{force ? Resolved(file) : file} {
  std::error_code ignored;
  const std::filesystem::file_status status = std::filesystem::status(path_, ignored);
  int flags = O_WRONLY | O_CLOEXEC;
  if (!force) {
    begins_as_ = path_;
    flags |= O_CREAT | O_EXCL;
  } else if (!std::filesystem::exists(status) || std::filesystem::is_regular_file(status)) {
    begins_as_ = path_.string() + ".part";
    flags |= O_CREAT | O_TRUNC;
  }
  descriptor_ = open(begins_as_.empty() ? path_.c_str() : begins_as_.c_str(), flags, 0666);
  if (descriptor_ >= 0) return;
  const int reason = errno;
  begins_as_.clear();
  if (reason == EEXIST)
    throw Error(path_.string() + " exists; give --force to write over it, or another place");
  Throw(reason);
}

LogFile::~LogFile() {
  if (descriptor_ >= 0) close(descriptor_);
  if (!begins_as_.empty()) unlink(begins_as_.c_str());
}

void LogFile::Begun() {
  if (begins_as_.empty()) return;
  if (begins_as_ != path_ && rename(begins_as_.c_str(), path_.c_str()) != 0) Throw(errno);
  begins_as_.clear();
}

void LogFile::Write(std::string_view bytes) {
  std::string_view rest = bytes;
  while (!rest.empty()) {
    const ssize_t written = write(descriptor_, rest.data(), rest.size());
    if (written >= 0) {
      rest.remove_prefix(static_cast<std::size_t>(written));
    } else if (errno != EINTR) {
      const int reason = errno;
      // The part that did fit would be half a record; a pipe cannot take it back.
      const std::size_t part = bytes.size() - rest.size();
      if (part == 0) Throw(reason);
      if (ftruncate(descriptor_, size_) == 0) Throw(reason);
      Throw(reason, "; half a record stays at its end, from byte " + Text(size_) + " on");
    }
  }
  size_ += static_cast<std::int64_t>(bytes.size());
}

void LogFile::Close() {
  // A full disk may show only when the file is closed.
  if (descriptor_ >= 0 && close(std::exchange(descriptor_, -1)) != 0) Throw(errno);
}

void LogFile::Throw(int reason, const std::string& besides) const {
  throw Error("cannot write " + path_.string() + ": " + std::strerror(reason) + besides);
}

}  // namespace pliant::internal
