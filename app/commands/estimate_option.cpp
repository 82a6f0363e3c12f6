#include "app/commands/estimate_option.h"

#include <string>
#include <utility>

#include <fmt/format.h>

#include "app/commands/resume_option.h"
#include "app/terminal.h"

namespace fettle::app {

namespace {

// Work that takes less begins without a word.
constexpr double kLongSeconds = 5.0;

}  // namespace

void addEstimateOption(Command command, bool& only) {
  command.add(
      {{.name = "--estimate",
        .to = &only,
        .text =
            "Do nothing: print the time, memory and disk that the work will take, from a sample of the same "
            "work on this machine"}},
      kLongWork);
}

engine::Result<Foreseen> foresee(const PlannedWork& work, const std::string& name, bool only,
                                 engine::JobControl& job) {
  auto estimate = estimateWork(work, only, job);
  // What is wrong with the input the work itself says, with its place.
  if (!estimate && !only && estimate.error().kind == engine::ErrorKind::kInput) return Foreseen{};
  if (!estimate) return tl::unexpected(estimate.error());
  Foreseen foreseen{*estimate, std::nullopt};
  if (*estimate) {
    if (auto room = checkRoom(**estimate, work); !room) return tl::unexpected(room.error());
    if (!only && (*estimate)->seconds() >= kLongSeconds)
      note(fmt::format("{}: {}", name, textOf(**estimate)));
  }
  if (only) {
    foreseen.only = *estimate ? reportOf(**estimate) : Report::object();
    (*foreseen.only)["text"] = *estimate ? textOf(**estimate) : "too little work for an estimate";
  }
  return foreseen;
}

}  // namespace fettle::app
