#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>
#include <system_error>

#include "pliant/systems/context.h"

namespace pliant {

namespace {

using internal::Role;
using internal::Slot;

constexpr std::string_view kMagic = "pliant snapshot 2\n";

std::uint64_t Checksum(std::string_view bytes) {
  return internal::Mixed(internal::kFingerprintSeed, bytes);
}

/// What a restored run needs; computed values follow, workspaces do not matter.
bool IsKept(const Slot& slot) {
  return slot.role == Role::Held || slot.role == Role::Free || slot.role == Role::Discrete ||
         slot.role == Role::Continuous;
}

template <class T>
void Put(std::string& bytes, const T& x) {
  internal::Write(x, bytes);
}
template <class T>
void Put(std::string& bytes, const std::vector<T>& all) {
  for (const T& x : all) Put(bytes, x);
}
template <class T>
const char* Take(T& x, const char* p, const char* end) {
  return internal::Read(x, p, end);
}
template <class T>
const char* Take(std::vector<T>& all, const char* p, const char* end) {
  for (T& x : all) p = Take(x, p, end);
  return p;
}

}  // namespace

void Context::Save(const std::filesystem::path& file) const {
  std::string bytes(kMagic);
  Put(bytes, plan_->fingerprint);
  Put(bytes, line_.next_tick);
  Put(bytes, line_.due);
  Put(bytes, line_.side);
  Put(bytes, line_.fired);
  Put(bytes, line_.quick);
  Put(bytes, line_.step);
  Put(bytes, line_.started);
  Put(bytes, line_.ended_by);
  for (const Slot& slot : plan_->slots) {
    if (!IsKept(slot)) continue;
    if (!slot.type->write)
      throw Error("cannot save " + slot.value->describe() +
                  "\ngive its type a function template Fields");
    slot.type->write(arena_ + slot.offset, bytes);
  }
  Put(bytes, Checksum(bytes));

  std::filesystem::path part = file;
  part += ".part";
  std::ofstream out(part, std::ios::binary | std::ios::trunc);
  out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  out.close();
  std::error_code error;
  if (out) std::filesystem::rename(part, file, error);
  if (!out || error) {
    const std::string reason = error ? error.message() : std::strerror(errno);
    std::filesystem::remove(part, error);
    throw Error("cannot write the snapshot " + file.string() + ": " + reason);
  }
}

void Context::Load(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw Error("cannot read the snapshot " + file.string() + ": " + std::strerror(errno));
  const std::string bytes{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  const auto refuse = [&](const std::string& why) {
    throw Error("cannot restore from " + file.string() + ": " + why);
  };
  if (!bytes.starts_with(kMagic)) refuse("it is no snapshot of this version");

  Context read(*this);
  const char* p = bytes.data() + kMagic.size();
  const char* const end =
      bytes.data() + std::max(bytes.size() - sizeof(std::uint64_t), kMagic.size());
  std::uint64_t fingerprint = 0, checksum = 0;
  Take(checksum, end, bytes.data() + bytes.size());
  if (checksum != Checksum({bytes.data(), end})) refuse("it is cut off or damaged");
  p = Take(fingerprint, p, end);
  if (fingerprint != plan_->fingerprint)
    refuse("it was taken of another diagram; build the diagram it was taken of");
  p = Take(read.line_.next_tick, p, end);
  p = Take(read.line_.due, p, end);
  p = Take(read.line_.side, p, end);
  p = Take(read.line_.fired, p, end);
  p = Take(read.line_.quick, p, end);
  p = Take(read.line_.step, p, end);
  p = Take(read.line_.started, p, end);
  p = Take(read.line_.ended_by, p, end);
  for (const Slot& slot : plan_->slots) {
    if (!IsKept(slot)) continue;
    if (!slot.type->write)
      throw Error("cannot restore " + slot.value->describe() +
                  "\ngive its type a function template Fields");
    p = slot.type->read(read.arena_ + slot.offset, p, end);
    if (!p) refuse("it ends or does not fit at " + (slot.value ? slot.value->path() : "the time"));
  }
  if (p != end) refuse("it is longer than the diagram's state");
  for (std::size_t i = 0; i < plan_->continuous.size(); ++i) read.StoreState(static_cast<int>(i));
  read.ResetValid();
  *this = std::move(read);
}

}  // namespace pliant
