#include "python/session_reader.h"

#include <optional>
#include <utility>

#include <fmt/chrono.h>
#include <fmt/format.h>

#include "engine/base/job.h"
#include "engine/field/seen_field.h"
#include "engine/formats/formats.h"
#include "engine/history/history.h"
#include "python/errors.h"
#include "python/waiting.h"

namespace fettle::python {

namespace py = pybind11;

SessionReader SessionReader::open(const std::string& path, const std::string& scan_path,
                                  const py::object& progress) {
  engine::SessionOpenOptions options;
  options.scan_path = scan_path;
  options.journal = engine::JournalReading::kLeave;
  engine::JobControl job;
  std::optional<engine::Result<engine::Session>> read;
  waitFor([&] { read = engine::openSession(path, options, engine::importField, job); }, job, progress);
  return SessionReader(valueOf(*std::move(read)));
}

std::vector<SessionStep> SessionReader::steps() const {
  std::vector<SessionStep> steps;
  for (std::int64_t k = first() + 1; k <= last(); ++k) {
    const engine::StepInfo& info = session_.history.info(k);
    steps.push_back(
        {k, info.name, std::string(engine::stepKindName(info.kind)), fmt::format("{:%FT%TZ}", info.time)});
  }
  return steps;
}

Scan SessionReader::field(std::int64_t state) const {
  if (state < first() || state > last())
    raise(engine::inputError(fmt::format("state {} is not held", state), "state",
                             fmt::format("take {} to {}", first(), last()))
              .value());
  engine::Imported imported;
  imported.field = session_.history.state(state);
  const bool inverted = imported.field.reader().sign() != session_.original.reader().sign();
  imported.original =
      (inverted ? session_.original.inverted() : session_.original).withForm(imported.field.form());
  imported.format = "Fettle";
  engine::JobControl job;
  const auto seen = valueOf(engine::SeenField::of(imported.field, job));
  imported.original = valueOf(seen.at(*imported.original, job)).seen();
  imported.field = seen.seen();
  return {std::move(imported)};
}

Scan SessionReader::original() const {
  engine::Imported imported;
  imported.field = session_.original;
  imported.format = session_.scan.format;
  return {std::move(imported)};
}

}  // namespace fettle::python
