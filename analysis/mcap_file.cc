#include "pliant/analysis/mcap_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <utility>

#include "pliant/analysis/mcap_format.h"
#include "pliant/systems/error.h"

namespace pliant::internal {

namespace {

constexpr std::uint64_t kWindow = 16 << 10;
constexpr std::uint64_t kBlock = 1 << 20;

}  // namespace

McapFile::McapFile(std::filesystem::path path)
    : name_{path.string()},
      place_{name_ + ": "},
      // A pipe without a writer must not make us wait.
      descriptor_{open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)} {
  if (descriptor_.get() < 0) throw Error("cannot read " + name_ + ": " + std::strerror(errno));
  struct stat status;
  if (fstat(descriptor_.get(), &status) != 0)
    throw Error("cannot read " + name_ + ": " + std::strerror(errno));
  if (!S_ISREG(status.st_mode)) throw Error("cannot read " + name_ + ": it is not a file");
  size_ = static_cast<std::uint64_t>(status.st_size);
  std::array<std::byte, 8> begin{};
  const std::size_t there = std::min<std::uint64_t>(size_, begin.size());
  Read(0, std::span(begin).first(there), there);
  if (std::memcmp(begin.data(), kMcapMagic.data(), begin.size()) != 0)
    throw Error(name_ + ": not an MCAP file: " +
                (size_ == 0 ? "it is empty" : "it does not begin with \\x89MCAP0\\r\\n"));
}

std::size_t McapFile::Read(std::uint64_t at, std::span<std::byte> to, std::size_t least) const {
  std::size_t done = 0;
  while (done < to.size()) {
    const ssize_t n =
        pread(descriptor_.get(), to.data() + done, to.size() - done, static_cast<off_t>(at + done));
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0 && done >= least) break;
    if (n < 0) throw Error(At(at + done) + "cannot read: " + std::strerror(errno));
    if (n == 0) throw Error(At(at + done) + "the file has become shorter while it was read");
    done += static_cast<std::size_t>(n);
  }
  return done;
}

std::uint32_t McapFile::Crc(std::uint64_t from, std::uint64_t to, std::uint32_t before) const {
  std::vector<std::byte> block(std::min(kBlock, to - from));
  std::uint32_t crc = before;
  while (from < to) {
    const std::span piece = std::span(block).first(std::min(kBlock, to - from));
    Read(from, piece, piece.size());
    crc = Crc32(piece, crc);
    from += piece.size();
  }
  return crc;
}

std::string McapFile::At(std::uint64_t at) const { return name_ + ": at byte " + Text(at) + ": "; }

Bytes McapWindow::At(std::uint64_t at, std::uint64_t n) {
  if (at > file_.size() || n > file_.size() - at)
    throw Error(file_.At(at) + Text(n) + " bytes wanted, the file ends at byte " +
                Text(file_.size()));
  if (at < begin_ || at + n > begin_ + bytes_.size()) {
    std::vector<std::byte> bytes = std::exchange(bytes_, {});  // a read that fails leaves nothing
    bytes.resize(std::min(std::max(n, kWindow), file_.size() - at));
    bytes.resize(file_.Read(at, bytes, n));
    bytes_ = std::move(bytes);
    begin_ = at;
  }
  return Bytes(bytes_).subspan(at - begin_, n);
}

}  // namespace pliant::internal
