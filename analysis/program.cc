#include "pliant/analysis/program.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>

#include "pliant/analysis/write_file.h"
#include "pliant/systems/descriptor.h"
#include "pliant/systems/error.h"

namespace pliant::internal {

namespace {

/// What a child process printed to its standard error, and whether it ended well.
struct Outcome {
  std::string message;
  bool succeeded;
};

struct FileActions {
  FileActions() { posix_spawn_file_actions_init(&actions); }
  ~FileActions() { posix_spawn_file_actions_destroy(&actions); }
  FileActions(const FileActions&) = delete;
  FileActions& operator=(const FileActions&) = delete;
  posix_spawn_file_actions_t actions;
};

[[noreturn]] void CannotRun(const std::string& name) {
  throw Error("cannot run " + name + ": " + std::strerror(errno));
}

/// A text in memory as a program reads it.
class InputFile {
 public:
  InputFile(const std::string& name, std::string_view text)
      : descriptor_{memfd_create("input", MFD_CLOEXEC)} {
    if (descriptor_.get() < 0) CannotRun(name);
    while (!text.empty()) {
      const ssize_t written = write(descriptor_.get(), text.data(), text.size());
      if (written < 0 && errno != EINTR) CannotRun(name);
      if (written > 0) text.remove_prefix(static_cast<std::size_t>(written));
    }
    lseek(descriptor_.get(), 0, SEEK_SET);
  }

  int descriptor() const { return descriptor_.get(); }

 private:
  Descriptor descriptor_;
};

std::string ReadAll(int descriptor) {
  std::string all;
  std::array<char, 4096> buffer;
  for (ssize_t n; (n = read(descriptor, buffer.data(), buffer.size())) != 0;) {
    if (n > 0) all.append(buffer.data(), static_cast<std::size_t>(n));
    if (n < 0 && errno != EINTR) break;
  }
  return all;
}

/// Its standard output goes to the descriptor `out`.
Outcome Run(const Program& program, const Program::Call& call, int out) {
  const InputFile input(program.name, call.input);
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) CannotRun(program.name);
  const Descriptor messages(ends[0]);
  Descriptor their_messages(ends[1]);

  FileActions files;
  posix_spawn_file_actions_addchdir_np(&files.actions, call.directory.c_str());
  posix_spawn_file_actions_adddup2(&files.actions, input.descriptor(), STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&files.actions, out, STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&files.actions, their_messages.get(), STDERR_FILENO);

  std::vector<std::string> words{program.name};
  words.insert(words.end(), call.arguments.begin(), call.arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);

  pid_t child = -1;
  const int failure =
      posix_spawnp(&child, program.name.c_str(), &files.actions, nullptr, argv.data(), environ);
  their_messages = Descriptor();
  Outcome outcome{failure ? "" : ReadAll(messages.get()), false};
  if (failure)
    throw Error("cannot run " + program.name + ", which " + program.task + ": " +
                std::strerror(failure) + "\ninstall the Debian package " + program.package +
                ", or put the directory of " + program.name + " on PATH");

  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) continue;
  outcome.succeeded = WIFEXITED(status) && WEXITSTATUS(status) == 0;
  return outcome;
}

bool Contains(const std::filesystem::path& file, std::string_view what) {
  std::ifstream in(file, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  return text.find(what) != std::string::npos;
}

}  // namespace

void Program::Draw(const Call& call, const std::filesystem::path& drawing,
                   std::string_view end) const {
  PartFile part(drawing);
  const Outcome outcome = Run(*this, call, part.descriptor());
  if (!outcome.succeeded)
    throw Error(name + " cannot draw " + drawing.string() + ": " + outcome.message);
  if (!Contains(drawing.string() + ".part", end))
    throw Error(name + " drew only a part of " + drawing.string() + "; is the disk full?" +
                (outcome.message.empty() ? "" : "\n" + outcome.message));
  part.MoveIntoPlace();
}

void Program::RequireThatItRuns(const Call& call) const {
  const Outcome outcome = Run(*this, call, STDERR_FILENO);
  Require(outcome.succeeded, name + " does not run: " + outcome.message);
}

}  // namespace pliant::internal
