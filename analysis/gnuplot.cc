#include "pliant/analysis/gnuplot.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>

#include "pliant/analysis/figure.h"
#include "pliant/analysis/write_file.h"
#include "pliant/systems/error.h"

namespace pliant {

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

std::string ReadAll(int descriptor) {
  std::string all;
  std::array<char, 4096> buffer;
  for (ssize_t n; (n = read(descriptor, buffer.data(), buffer.size())) != 0;) {
    if (n > 0) all.append(buffer.data(), static_cast<std::size_t>(n));
    if (n < 0 && errno != EINTR) break;
  }
  return all;
}

/// gnuplot with `arguments`, its standard output to the descriptor `out`.
Outcome Gnuplot(const std::filesystem::path& directory, std::vector<std::string> arguments,
                int out) {
  int messages[2];
  if (pipe2(messages, O_CLOEXEC) != 0)
    throw Error(std::string("cannot run gnuplot: ") + std::strerror(errno));

  FileActions files;
  posix_spawn_file_actions_addchdir_np(&files.actions, directory.c_str());
  posix_spawn_file_actions_addopen(&files.actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&files.actions, out, STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&files.actions, messages[1], STDERR_FILENO);

  arguments.insert(arguments.begin(), {"gnuplot", "-d"});
  std::vector<char*> argv;
  for (std::string& argument : arguments) argv.push_back(argument.data());
  argv.push_back(nullptr);

  pid_t child = -1;
  const int failure =
      posix_spawnp(&child, "gnuplot", &files.actions, nullptr, argv.data(), environ);
  close(messages[1]);
  Outcome outcome{failure ? "" : ReadAll(messages[0]), false};
  close(messages[0]);
  if (failure)
    throw Error(
        std::string("cannot run gnuplot, which draws the figures of a report: ") +
        std::strerror(failure) +
        "\ninstall the Debian package gnuplot-nox, or put the directory of gnuplot on PATH");

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

void internal::RunGnuplot(const std::filesystem::path& directory,
                          const std::vector<std::string>& arguments,
                          const std::filesystem::path& drawing, std::string_view end) {
  PartFile part(drawing);
  const Outcome outcome = Gnuplot(directory, arguments, part.descriptor());
  if (!outcome.succeeded)
    throw Error("gnuplot cannot draw " + drawing.string() + ": " + outcome.message);
  if (!Contains(drawing.string() + ".part", end))
    throw Error("gnuplot drew only a part of " + drawing.string() + "; is the disk full?" +
                (outcome.message.empty() ? "" : "\n" + outcome.message));
  part.MoveIntoPlace();
}

void RequireGnuplot() {
  const Outcome outcome = Gnuplot(".", {"-e", "exit"}, STDERR_FILENO);
  Require(outcome.succeeded, "gnuplot does not run: " + outcome.message);
}

}  // namespace pliant
