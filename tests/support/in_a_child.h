#pragma once

#include <sys/wait.h>
#include <unistd.h>

#include <exception>
#include <string>

namespace pliant {

/// What `act` returns, done in a copy of this process: what it gives up there is not given up here.
template <class Act>
std::string InAChild(const Act& act) {
  int ends[2];
  if (pipe(ends) != 0) return "no pipe";
  const pid_t child = fork();
  if (child == 0) {
    std::string text;
    try {
      text = act();
    } catch (const std::exception& e) {
      text = std::string("the child threw: ") + e.what();
    }
    const bool written = write(ends[1], text.data(), text.size()) == std::ssize(text);
    _exit(written ? 0 : 1);
  }
  close(ends[1]);
  std::string text;
  char buffer[4096];
  for (ssize_t n; (n = read(ends[0], buffer, sizeof buffer)) > 0;)
    text.append(buffer, static_cast<std::size_t>(n));
  close(ends[0]);
  int status = 0;
  waitpid(child, &status, 0);
  return status == 0 ? text : text + "; the child ended with " + std::to_string(status);
}

}  // namespace pliant
