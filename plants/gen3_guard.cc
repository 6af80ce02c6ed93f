#include "pliant/plants/gen3_guard.h"

#include <fcntl.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <thread>

#include "pliant/plants/kortex_request.h"
#include "pliant/plants/kortex_services.h"
#include "pliant/systems/error.h"

namespace pliant {

namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

/// Leaves all that was the parent's but the standard error; returns the socket's new number.
int Part(int word) {
  constexpr int kWord = 3;
  setsid();
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGTSTP, SIGPIPE})
    std::signal(signal, SIG_IGN);
  prctl(PR_SET_NAME, "pliant guard");
  const sched_param none{};
  sched_setscheduler(0, SCHED_OTHER, &none);
  if (word != kWord) dup2(word, kWord);
  close_range(kWord + 1, ~0U, 0);
  const int nowhere = open("/dev/null", O_RDWR);
  dup2(nowhere, STDIN_FILENO);
  dup2(nowhere, STDOUT_FILENO);
  if (nowhere > kWord) close(nowhere);
  if (chdir("/") != 0) return kWord;  // a folder that can be unmounted, where it can be left
  return kWord;
}

/// False if the parent is gone without a word.
bool HearsTheWord(int word) {
  char said;
  for (;;) {
    const ssize_t came = recv(word, &said, 1, 0);
    if (came >= 0 || errno != EINTR) return came == 1;
  }
}

void Say(const std::string& line) {
  const std::string text = "pliant: " + line + "\n";
  if (write(STDERR_FILENO, text.data(), text.size()) < 0) return;  // nobody is left to be told
}

// An exception must not lead back into what the parent did.
void HandBack(const Gen3Address& address, std::chrono::milliseconds patience) noexcept {
  const std::string who = "the process that ran the arm at " + address.text() + " is gone";
  const auto until = Clock::now() + patience;
  for (;;) {
    std::string fault;
    try {
      kortex::Services services(address);
      for (int j = 0; j < kGen3Joints; ++j) try {
          services.SetMode(j, Gen3Mode::Position);
        } catch (const Error&) {
          // As of an arm that is out of low-level servoing: what follows tells.
        }
      services.SetServoing(Gen3Servoing::SingleLevel);
      return Say(who + "; the arm was set to single-level servoing");
    } catch (const std::exception& e) {
      fault = e.what();
    }
    if (Clock::now() >= until)
      return Say(who + ", and the arm could not be handed back: " + fault +
                 "; `pliant recover gen3` tries again");
    std::this_thread::sleep_for(100ms);
  }
}

}  // namespace

Gen3Guard::Gen3Guard(const Gen3Address& address, std::chrono::milliseconds patience) {
  Gen3Address there = address;
  try {
    there.host = Resolved(address.host);
  } catch (const Error& e) {
    throw kortex::Unreachable(address, e.what());
  }
  // One that answers at all does so in less, and others of the tries may.
  there.answer_limit = std::min(there.answer_limit, 3000ms);
  int ends[2];
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0)
    throw Error(std::string("cannot guard the arm: no pair of sockets: ") + std::strerror(errno));
  Socket ours(ends[0]), its(ends[1]);
  child_ = fork();
  if (child_ < 0)
    throw Error(std::string("cannot guard the arm: no process to do it: ") + std::strerror(errno));
  if (child_ == 0) {
    const int word = Part(its.descriptor());
    if (!HearsTheWord(word)) HandBack(there, patience);
    _exit(0);
  }
  word_ = std::move(ours);
}

Gen3Guard::~Gen3Guard() {
  const char all_is_well = 1;
  if (!handed_back_)
    word_ = Socket(-1);
  else if (send(word_.descriptor(), &all_is_well, 1, MSG_NOSIGNAL) != 1)
    kill(child_, SIGKILL);
  while (waitpid(child_, nullptr, 0) < 0 && errno == EINTR) {
  }
}

}  // namespace pliant
