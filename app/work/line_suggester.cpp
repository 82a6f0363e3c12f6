#include "app/work/line_suggester.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include <fmt/format.h>

#include "app/texts/texts.h"
#include "app/work/read_units.h"

namespace fettle::app {
namespace {

std::string saidOf(const engine::LineSuggestion& found, const engine::Version& field) {
  const engine::LengthUnit& unit = field.grid().height_unit;
  // One unit for all of them: that of what is to go.
  const ReadAs as = readOnScreenAs(found.before, unit.mm, unit.name);
  const auto apart = [&as](double height) {
    const double shown = height / as.size;
    return shown < 1000.0 ? fmt::format("{:.3g}", shown) : fmt::format("{:.0f}", shown);
  };
  std::string text;
  if (found.best) {
    const engine::LineSuggestion::Tried& best = found.tried[*found.best];
    text =
        trFormat("suggested: {}: lines lie {} {} apart then, {} now",
                 tr(lineWayName(best.method, best.degree)), apart(best.apart), as.name, apart(found.before));
  } else {
    text =
        trFormat("no way brings lines closer together: they lie {} {} apart", apart(found.before), as.name);
  }
  std::string others;
  for (std::size_t i = 0; i < found.tried.size(); ++i)
    if (found.best != i)
      others += (others.empty() ? "" : ", ") +
                fmt::format("{} {}", tr(lineWayName(found.tried[i].method, found.tried[i].degree)),
                            apart(found.tried[i].apart));
  text += "; " + others;
  if (found.places < found.length)
    text += trFormat("; by {} of the {} samples of each line", found.places, found.length);
  return text;
}

}  // namespace

const char* lineWayName(engine::LineMethod method, int degree) noexcept {
  static constexpr const char* kPolynomials[] = {textOf("mean"), textOf("straight line"),
                                                 textOf("polynomial 2"), textOf("polynomial 3")};
  switch (method) {
    case engine::LineMethod::kMedian:
      return textOf("median");
    case engine::LineMethod::kDifference:
      return textOf("difference");
    case engine::LineMethod::kMatching:
      return textOf("matching");
    case engine::LineMethod::kPolynomial:
      break;
  }
  return kPolynomials[static_cast<std::size_t>(std::clamp(degree, 0, engine::LineOptions::kMostDegree))];
}

void LineSuggester::search(const LoopClient& client, const engine::LineOptions& lines) {
  on_trial_ = client.newest();
  asked_ = lines;
  working_.replace([field = on_trial_, lines](engine::JobControl& job) {
    return engine::suggestLevelling(field, lines, job);
  });
}

void LineSuggester::clear() {
  cancel();
  on_trial_ = tried_ = {};
  suggested_.reset();
  says_.clear();
  outdated_ = false;
}

bool LineSuggester::poll(const LoopClient& client, std::vector<Notice>& notices) {
  bool changed = false;
  const bool dropped = working_.cancelling();
  if (auto done = working_.take()) {
    changed = true;
    if (!dropped && *done) {
      tried_ = std::exchange(on_trial_, {});
      says_ = saidOf(**done, tried_);
      suggested_.reset();
      if ((*done)->best) {
        const engine::LineSuggestion::Tried& best = (*done)->tried[*(*done)->best];
        suggested_ = asked_;
        suggested_->method = best.method;
        suggested_->degree = best.degree;
      }
    } else if (!dropped && done->error().kind != engine::ErrorKind::kCancelled) {
      notices.push_back(noticeOf(done->error()));
    }
  }
  const bool outdated = !tried_.empty() && !(client.newest() == tried_);
  return std::exchange(outdated_, outdated) != outdated || changed;
}

}  // namespace fettle::app
