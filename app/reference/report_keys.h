#pragma once

#include <vector>

#include "app/reference/report_schema.h"

namespace fettle::app::reports {

// Keys that reports of several commands have, and the reports of each kind of command. All build new lists; any thread.

using Keys = std::vector<ReportKey>;

[[nodiscard]] ReportKey hash();
[[nodiscard]] ReportKey machine();
[[nodiscard]] ReportKey repeats();
[[nodiscard]] ReportKey unit();
[[nodiscard]] ReportKey rows(Keys keys);
/// The fields of a figure that a candidate of --suggest has.
[[nodiscard]] Keys candidate();
[[nodiscard]] Keys places();
[[nodiscard]] Keys joined(Keys first, const Keys& second);
[[nodiscard]] Keys suggestion();
[[nodiscard]] Keys timing();
/// Of a figure of an estimate: the middle ones of the runs, and the ratio of expected to real.
[[nodiscard]] Keys expectedAndReal();
[[nodiscard]] Keys estimated();
/// The forms of --estimate.
[[nodiscard]] ReportForm estimateAlone();
[[nodiscard]] ReportForm noEstimate();
/// Of commands whose work can be divided: one shard's, and all of them after each other.
[[nodiscard]] ReportForm shardDone();
[[nodiscard]] ReportForm bandsInTurn();
/// Of all shards together.
[[nodiscard]] Keys gathered();
/// The form that lies over a scan as a layer, of what is measured without it.
[[nodiscard]] ReportKey layer();
/// What is taken out of a surface before it is measured.
[[nodiscard]] Keys form();
[[nodiscard]] Keys formFigures();
/// Of a form that is a sphere, cylinder or cone.
[[nodiscard]] Keys shapeFigures();

/// Of info, measure, features, fit, lines, journal, recipe, devices.
[[nodiscard]] std::vector<ReportSchema> inspecting();
/// Of section.
[[nodiscard]] std::vector<ReportSchema> sectioning();
/// Of compare, align, mosaic.
[[nodiscard]] std::vector<ReportSchema> comparing();
/// Of filter, convert, level, fill, transform, report, apply, mark, synth, replay, record.
[[nodiscard]] std::vector<ReportSchema> changing();
/// Of plan, gather, status, submit.
[[nodiscard]] std::vector<ReportSchema> sharing();
/// Of render, view, demo, accuracy, reference.
[[nodiscard]] std::vector<ReportSchema> showing();
/// Of the benchmarks.
[[nodiscard]] std::vector<ReportSchema> measuring();

}  // namespace fettle::app::reports
