#include "base/subprocess.h"

#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <fstream>
#include <string_view>
#include <system_error>

namespace axisfit {
namespace {

/// Allows this process so many bytes more than it has. Where the system does not tell how many that
/// is, there is no limit.
void limit_memory(std::size_t more) {
  std::size_t size = 0, resident = 0, shared = 0, text = 0, library = 0, data = 0;
  if (!(std::ifstream("/proc/self/statm") >> size >> resident >> shared >> text >> library >> data))
    return;
  const rlim_t most = data * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE)) + more;
  const rlimit limit{most, most};
  ::setrlimit(RLIMIT_DATA, &limit);
}

/// Does the work as the other process, which ends here.
[[noreturn]] void run_and_exit(const std::function<std::string()>& work, int pipe) {
  // A crash is an answer too, and nothing to be told of by whoever handles signals.
  for (const int signal : {SIGSEGV, SIGBUS, SIGABRT, SIGFPE, SIGILL}) ::signal(signal, SIG_DFL);
  try {
    const std::string text = work();
    for (std::string_view remaining = text; !remaining.empty();) {
      const ssize_t n = ::write(pipe, remaining.data(), remaining.size());
      if (n < 0 && errno != EINTR) ::_exit(1);
      if (n > 0) remaining.remove_prefix(static_cast<std::size_t>(n));
    }
  } catch (...) {
    ::_exit(1);
  }
  ::_exit(0);
}

std::string read_all(int pipe) {
  std::string text;
  std::array<char, 1 << 16> part;
  while (true) {
    const ssize_t n = ::read(pipe, part.data(), part.size());
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return text;
    text.append(part.data(), static_cast<std::size_t>(n));
  }
}

}  // namespace

std::optional<std::string> run_in_subprocess(const std::function<std::string()>& work,
                                             std::size_t memory) {
  const auto fail = [] {
    throw std::system_error(errno, std::generic_category(), "cannot start another process");
  };
  std::array<int, 2> ends{};
  if (::pipe(ends.data()) != 0) fail();
  const pid_t child = ::fork();
  if (child < 0) {
    ::close(ends[0]);
    ::close(ends[1]);
    fail();
  }
  if (child == 0) {
    ::close(ends[0]);
    limit_memory(memory);
    run_and_exit(work, ends[1]);
  }
  ::close(ends[1]);
  std::string text = read_all(ends[0]);
  ::close(ends[0]);
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) return std::nullopt;
  return text;
}

}  // namespace axisfit
