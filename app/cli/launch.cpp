// SPDX-License-Identifier: Apache-2.0
// `sunder`: holds SIGINT and SIGTERM back and becomes `sunder-program` beside it, which waits for
// them as soon as it runs. Loading the libraries of that takes a tenth of a second and more, in
// which a signal would end it raw; this loads the C library alone.
#include <unistd.h>

#include <cerrno>
#include <climits>
#include <csignal>
#include <cstdio>
#include <cstring>

int main(int, char** argv) {
  sigset_t set;
  sigemptyset(&set);
  sigaddset(&set, SIGINT);
  sigaddset(&set, SIGTERM);
  sigprocmask(SIG_BLOCK, &set, nullptr);  // outlasts exec

  char path[PATH_MAX + 16] = "";
  const ssize_t length = readlink("/proc/self/exe", path, PATH_MAX);
  char* const name = length > 0 ? std::strrchr(path, '/') : nullptr;
  if (name) {
    std::strcpy(name + 1, "sunder-program");
    execv(path, argv);
  }
  std::fprintf(stderr, "sunder: error: cannot start %s: %s; it belongs beside the program sunder\n",
               path, std::strerror(errno));
  return 1;
}
