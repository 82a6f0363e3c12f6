// session_kill_driver FILE SEED WIDTH HEIGHT create|resume READY
// Works on a session as Play does, as fast as the writer keeps up with, until it is killed. Reports on
// stdout, a line each:
//   ready          the session exists and is open; the file READY is made as well
//   begun N        action N is about to be handed to the writer
//   committed N    the writer has reported that nothing waits any more

#include <cstdio>
#include <cstdlib>
#include <string>
#include <thread>

#include <unistd.h>

#include <fmt/format.h>

#include "engine/formats/formats.h"
#include "tests/engine/session/play.h"

using namespace fettle::engine;

namespace {

// Straight to the system: what was reported is known even if the next instruction is the last.
void report(const std::string& line) {
  if (write(STDOUT_FILENO, line.data(), line.size()) < 0) std::exit(0);
}

int refuse(const Error& error) {
  std::fprintf(stderr, "%s\n", error.line().c_str());
  return 1;
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 7) return 2;
  const std::string path = arguments[1];
  const std::uint64_t seed = std::strtoull(arguments[2], nullptr, 10);
  SessionWriterOptions options;
  options.checkpoint_bytes = 300 << 10;  // often, so that many kills fall into one
  JobControl job;
  std::unique_ptr<SessionWriter> writer;
  std::unique_ptr<Play> play;
  if (arguments[5] == std::string("create")) {
    play = std::make_unique<Play>(seed, std::atoi(arguments[3]), std::atoi(arguments[4]));
    auto created = SessionWriter::create(play->session, path, options, job);
    if (!created) return refuse(created.error());
    writer = std::move(*created);
  } else {
    auto resumed = SessionWriter::open(path, {}, options, importField, job);
    if (!resumed) return refuse(resumed.error());
    writer = std::move(resumed->writer);
    play = std::make_unique<Play>(seed, resumed->session);
  }
  report("ready\n");
  if (std::FILE* ready = std::fopen(arguments[6], "w")) std::fclose(ready);
  std::string before;  // reported in one write with what follows it: between two actions there is no moment
  for (;;) {
    const std::int64_t n = play->actions() + 1;
    report(before + fmt::format("begun {}\n", n));
    play->act(writer.get());
    for (SessionStatus status = writer->status(); status.waiting != 0; status = writer->status()) {
      if (status.error) return refuse(*status.error);
      std::this_thread::sleep_for(std::chrono::microseconds(100));
    }
    before = fmt::format("committed {}\n", n);
  }
}
