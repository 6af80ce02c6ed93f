#include "pliant/analysis/sweep_part.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <optional>
#include <span>
#include <string_view>
#include <thread>
#include <utility>

#include "pliant/analysis/mcap_byte_reader.h"
#include "pliant/analysis/printable.h"
#include "pliant/analysis/write_file.h"

namespace pliant {

using internal::ByteReader, internal::BytesOf, internal::Crc32, internal::TextOf;

namespace {

constexpr std::string_view kMagic = "pliant sweep 1\n", kRow = "row\n";
constexpr std::size_t kMostRow = 64 * 1024;

template <class T>
void Put(std::string& bytes, T value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

void PutText(std::string& bytes, const std::string& text) {
  Put(bytes, static_cast<std::uint32_t>(text.size()));
  bytes += text;
}

/// Of the size and the content.
std::uint32_t CrcOf(std::string_view content) {
  const auto size = static_cast<std::uint32_t>(content.size());
  return Crc32(BytesOf(content), Crc32(std::as_bytes(std::span(&size, 1))));
}

/// Magic, size, checksum, content.
std::string Framed(std::string_view magic, const std::string& content) {
  std::string bytes(magic);
  Put(bytes, static_cast<std::uint32_t>(content.size()));
  Put(bytes, CrcOf(content));
  return bytes + content;
}

/// What a frame at the front of bytes holds, if there is a whole one.
std::optional<std::string_view> ContentOf(std::string_view bytes, std::string_view magic,
                                          std::size_t most) {
  if (!bytes.starts_with(magic)) return std::nullopt;
  try {
    ByteReader in(BytesOf(bytes.substr(magic.size())), "", 0);
    const auto size = in.Take<std::uint32_t>("size"), crc = in.Take<std::uint32_t>("checksum");
    if (size > most) return std::nullopt;
    const std::string_view content = TextOf(in.TakeBytes(size, "content"));
    return CrcOf(content) == crc ? std::optional(content) : std::nullopt;
  } catch (const Error&) {
    return std::nullopt;
  }
}

std::string ContentOf(const SweepRow& row) {
  std::string bytes;
  Put(bytes, row.run);
  Put(bytes, static_cast<std::uint32_t>(row.random.size()));
  Put(bytes, static_cast<std::uint32_t>(row.numbers.size()));
  for (const auto* numbers : {&row.random, &row.numbers})
    for (const double number : *numbers) Put(bytes, number);
  PutText(bytes, row.ended);
  PutText(bytes, row.failed);
  return bytes;
}

std::optional<SweepRow> RowOf(std::string_view content) try {
  ByteReader in(BytesOf(content), "", 0);
  SweepRow row;
  row.run = in.Take<std::uint64_t>("run");
  const std::size_t random = in.Take<std::uint32_t>("count"),
                    numbers = in.Take<std::uint32_t>("count");
  for (const auto& [all, count] :
       {std::pair(&row.random, random), std::pair(&row.numbers, numbers)})
    for (std::size_t i = 0; i < count; ++i) all->push_back(in.Take<double>("number"));
  row.ended = in.TakeText("cause");
  row.failed = in.TakeText("cause");
  return in.empty() ? std::optional(row) : std::nullopt;
} catch (const Error&) {
  return std::nullopt;
}

/// Whether bytes end before what their size says.
bool IsCutShort(std::string_view bytes) {
  std::uint32_t size = 0;
  constexpr std::size_t kHead = 2 * sizeof size;
  if (bytes.size() < kHead) return true;
  std::memcpy(&size, bytes.data(), sizeof size);
  return size <= Sweep::kMostText && bytes.size() < kHead + size;
}

SweepPartContent Parsed(std::string_view bytes, const std::filesystem::path& file) {
  SweepPartContent part;
  const std::size_t compared = std::min(bytes.size(), kMagic.size());
  if (bytes.substr(0, compared) != kMagic.substr(0, compared))
    throw Error(file.string() + ": expected a part of a sweep, which begins with '" +
                Printable(kMagic.substr(0, kMagic.size() - 1)) + "'; take the file away");
  const auto head = ContentOf(bytes, kMagic, Sweep::kMostText);
  if (!head) {
    // A process that was killed as it began has left less than its head says, and no row.
    if (IsCutShort(bytes.substr(compared)) && bytes.find(kRow) == bytes.npos) return part;
    throw Error(file.string() +
                ": its head, which says what is swept, is damaged; take the file away, and the "
                "sweep makes its runs again");
  }
  part.text = *head;
  const std::size_t frame = kRow.size() + 2 * sizeof(std::uint32_t);
  std::size_t at = kMagic.size() + 2 * sizeof(std::uint32_t) + head->size();
  part.whole = at;
  while (at < bytes.size()) {
    if (const auto content = ContentOf(bytes.substr(at), kRow, kMostRow)) {
      if (std::optional<SweepRow> row = RowOf(*content)) {
        if (part.whole < at)
          part.damaged.push_back("bytes " + Text(part.whole) + " to " + Text(at) + " are no row");
        part.rows.push_back(*std::move(row));
        at += frame + content->size();
        part.whole = at;
        continue;
      }
    }
    at = std::min(bytes.find(kRow, at + 1), bytes.size());
  }
  if (part.whole < bytes.size())
    part.damaged.push_back("bytes " + Text(part.whole) + " to " + Text(bytes.size()) +
                           ", its end, are no row");
  return part;
}

[[noreturn]] void ThrowOf(const std::filesystem::path& file, const char* act) {
  throw Error("cannot " + std::string(act) + " " + file.string() + ": " + std::strerror(errno));
}

}  // namespace

SweepPartContent SweepPartContent::Read(const std::filesystem::path& file) {
  return Parsed(internal::ReadFile(file), file);
}

void RequireSameSweep(const Sweep& sweep, const std::filesystem::path& file,
                      const std::string& text) {
  if (text == sweep.text()) return;
  const auto take_line = [](std::string_view& rest) {
    const std::string_view line = rest.substr(0, rest.find('\n'));
    rest.remove_prefix(std::min(rest.size(), line.size() + 1));
    return line;
  };
  std::string_view theirs = text, ours = sweep.text(), their_line, our_line;
  while (their_line == our_line && !(theirs.empty() && ours.empty())) {
    their_line = take_line(theirs);
    our_line = take_line(ours);
  }
  const auto differ = std::ranges::mismatch(their_line, our_line).in1 - their_line.begin();
  const auto shown = [&](std::string_view line) {
    const std::size_t from = std::min(line.find_first_not_of(" -"), line.size());
    // Of a long line the place where the other one goes on differently.
    std::size_t begin = std::max(from, static_cast<std::size_t>(std::max(0L, differ - 100L)));
    while (begin < line.size() && (line[begin] & 0xC0) == 0x80) ++begin;  // no half of a letter
    return line.empty() ? "nothing"
                        : (begin > from ? "…" : "") +
                              Printable(FirstBytes(std::string(line.substr(begin)), 200));
  };
  throw Error(file.string() + ": it is a part of another sweep\n  it has      " +
              shown(their_line) + "\n  this sweep  " + shown(our_line) +
              "\ngive another --out, or take the parts there away");
}

std::vector<std::filesystem::path> SweepPartsIn(const std::filesystem::path& directory) {
  const auto is_of_part = [](const std::string& name) {
    int length = 0;
    std::sscanf(name.c_str(), "part-%*[0-9]-of-%*[0-9]%n", &length);
    return length == static_cast<int>(name.size());
  };
  std::vector<std::filesystem::path> parts;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(directory, error))
    if (is_of_part(entry.path().filename().string()) && entry.is_regular_file(error))
      parts.push_back(entry.path());
  if (error)
    throw Error("cannot read the directory " + directory.string() + ": " + error.message());
  std::ranges::sort(parts);
  return parts;
}

bool IsBeingWritten(const std::filesystem::path& file) {
  const internal::Descriptor part(open(file.c_str(), O_RDONLY | O_CLOEXEC));
  return part.get() >= 0 && flock(part.get(), LOCK_SH | LOCK_NB) != 0 && errno == EWOULDBLOCK;
}

SweepPart::SweepPart(std::filesystem::path file, const Sweep& sweep)
    : file_{std::move(file)}, descriptor_{open(file_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666)} {
  if (descriptor_.get() < 0) ThrowOf(file_, "write");
  Open(sweep);
}

void SweepPart::Open(const Sweep& sweep) {
  if (!std::filesystem::is_regular_file(file_))
    throw Error(file_.string() + ": expected a file for a part of the sweep; give another --out");
  // IsBeingWritten of another process has the lock for a moment.
  for (int k = 0; flock(descriptor_.get(), LOCK_EX | LOCK_NB) != 0; ++k) {
    if (errno == EWOULDBLOCK && k < 10) {
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
      continue;
    }
    if (errno == EWOULDBLOCK)
      throw Error(file_.string() + ": another process writes it; wait for it, or end it");
    ThrowOf(file_, "lock");
  }
  const std::string bytes = internal::ReadFile(file_);
  SweepPartContent content = Parsed(bytes, file_);
  for (const std::string& damaged : content.damaged)
    damage_.push_back(file_.string() + ": " + damaged + "; the runs it lacks are made again");
  if (content.whole > 0) RequireSameSweep(sweep, file_, content.text);
  rows_ = std::move(content.rows);
  end_ = content.whole;
  if (end_ < bytes.size() && ftruncate(descriptor_.get(), static_cast<off_t>(end_)) != 0)
    ThrowOf(file_, "cut");
  if (end_ == 0) Write(Framed(kMagic, sweep.text()));
}

void SweepPart::Append(const SweepRow& row) { Write(Framed(kRow, ContentOf(row))); }

void SweepPart::Write(const std::string& bytes) {
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t written = pwrite(descriptor_.get(), bytes.data() + done, bytes.size() - done,
                                   static_cast<off_t>(end_ + done));
    if (written >= 0) {
      done += static_cast<std::size_t>(written);
    } else if (errno != EINTR) {
      const int reason = errno;
      // Half a row would be cut anyway.
      if (ftruncate(descriptor_.get(), static_cast<off_t>(end_)) != 0) errno = reason;
      errno = reason;
      ThrowOf(file_, "write");
    }
  }
  end_ += bytes.size();
}

}  // namespace pliant
