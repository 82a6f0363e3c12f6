#include "app/reference/report_keys.h"

namespace fettle::app::reports {

namespace {

ReportKey planId() {
  return {"plan", "string", "id of the plan"};
}

Keys planned() {
  return {{"command", "string", "filter or convert"},
          {"settings", "object", "options that all shards must have", {{"*", "any", ""}}},
          {"in", "string", ""},
          {"in_bytes", "integer", ""},
          {"in_print", "string", "size and some bytes of the input"},
          {"out", "string", ""},
          {"width", "integer", "samples"},
          {"height", "integer", "samples"},
          {"shards", "integer", ""},
          {"halo", "integer", "rows around a band that its samples depend on"},
          {"lines", "boolean", "whether the field has edge lines"},
          {"range_sigma", "number?", "height unit; of the whole field's noise where none was given"},
          {"max_change", "number?", "limit of change from the original, height unit"},
          unit(),
          {"revision", "integer", "of the filters' results"},
          {"one_file", "boolean", "whether all shards write rows of one file"},
          {"first_byte?", "integer", "of that file's samples"},
          {"file_bytes?", "integer", "of that file"},
          {"id", "string", "hash of the keys above"},
          {"arguments", "[string]", "of a shard, without --shard"},
          {"folder", "string", "that these were typed in"},
          {"threads", "integer", "of a shard, for which the next two are foreseen"},
          {"seconds_per_shard", "number", "foreseen on this machine, of the largest; 0: not foreseen"},
          {"memory_per_shard", "integer", "bytes, at most"}};
}

}  // namespace

ReportForm shardDone() {
  return {"--shard of one scan",
          {{"shard", "integer", "counted from 1"},
           {"shards", "integer", ""},
           planId(),
           {"filter?", "string", ""},
           {"row", "integer", "first row of the band, counted from the one with the lowest y"},
           {"rows", "integer", "of the band; 0 where there are more shards than rows of tiles"},
           {"read_rows", "integer", "that were read for it"},
           unit(),
           {"samples", "integer", "of the band that are not holes"},
           {"no_data", "integer", "holes of the band"},
           {"changed", "integer", "samples"},
           {"max_change", "number", "from the input, height unit"},
           {"squares", "number", "of changes, summed, height unit squared"},
           {"hash", "string", "of the band's samples"},
           {"read_seconds", "number", ""},
           {"work_seconds", "number", "of filter and writing"},
           {"seconds", "number", "of all"},
           {"peak_memory_bytes", "integer", "of the process"},
           {"host", "string", "name of the machine"},
           {"finished_before?", "boolean", "an earlier run did it, and this is the report of that"}}};
}

Keys gathered() {
  return {{"shards", "integer", ""},
          planId(),
          {"filter?", "string", ""},
          {"range_sigma", "number?", "height unit"},
          unit(),
          {"changed", "integer", "samples"},
          {"max_change", "number", "from the input, height unit"},
          {"rms_change", "number", "height unit"},
          {"no_data", "integer", "holes"},
          {"shard_seconds", "number", "of all shards, summed"},
          {"out", "string", "what was written"},
          {"hash", "string", "of the samples of the result"}};
}

ReportForm bandsInTurn() {
  return {"--shards-in-turn",
          joined(gathered(), {{"bands", "integer", "that were worked on one after another"},
                              {"bands_kept", "integer", "of these that an earlier run had done"},
                              {"peak_memory_bytes", "integer", "of the process"}})};
}

std::vector<ReportSchema> sharing() {
  return {{"plan filter", 1, {{"", planned()}}},
          {"plan convert", 1, {{"", planned()}}},
          {"gather",
           1,
           {{"the shards of one scan", gathered()},
            {"those of a list; of one alone in its file",
             {{"shard?", "integer", "of its file"},
              {"work?", "string", "of its file: hash of the command and its list"},
              {"shards", "integer", ""},
              {"done", "integer", "scans"},
              {"failed", "integer", "scans"},
              {"files", "[object]", "one for each scan, as the command reports it", {{"*", "any", ""}}}}}}},
          {"status",
           1,
           {{"",
             {{"shards", "integer", ""},
              {"done", "[integer]", "numbers of shards"},
              {"running",
               "[object]",
               "shards that said so in the last 20 s",
               {{"shard", "integer", ""},
                {"host", "string", ""},
                {"stage", "string", ""},
                {"share", "number", "of the stage, 0 to 1"}}},
              {"stopped", "[integer]", "shards that ran and say nothing any more"},
              {"waiting", "[integer]", "shards that never ran"},
              {"share", "number", "of the whole work that is done, 0 to 1"},
              {"seconds_left", "number", "by the shards that are done, else as foreseen"}}}}},
          {"submit",
           1,
           {{"",
             {{"engine", "string", "slurm, mpi or local"},
              {"shards", "integer", ""},
              {"threads", "integer", "of a shard"},
              {"memory_per_shard", "integer", "bytes"},
              {"seconds_per_shard", "number", ""},
              {"script", "string", "of the shell"},
              {"run", "boolean", "whether it was run"}}}}}};
}

}  // namespace fettle::app::reports
