#include "app/commands/shards/shard_plan.h"

#include <algorithm>
#include <fstream>
#include <utility>

#include <fmt/format.h>

#include "engine/io/export.h"
#include "engine/io/files/input_file.h"
#include "engine/resume/work_identity.h"

namespace fettle::app {

namespace {

std::uint64_t fnv(std::uint64_t hash, const char* bytes, std::size_t size) {
  for (std::size_t i = 0; i < size; ++i) hash = (hash ^ static_cast<unsigned char>(bytes[i])) * 0x100000001b3;
  return hash;
}

constexpr std::uint64_t kFnvStart = 0xcbf29ce484222325;

Report orNull(const std::optional<double>& value) {
  return value ? Report(*value) : Report();
}

std::optional<double> numberOrNone(const Report& value) {
  return value.is_number() ? std::optional(value.get<double>()) : std::nullopt;
}

Report identifying(const ShardPlan& plan) {
  Report report{{"command", plan.command},
                {"settings", plan.settings},
                {"in", plan.in},
                {"in_bytes", plan.in_bytes},
                {"in_print", plan.in_print},
                {"out", plan.out},
                {"width", plan.width},
                {"height", plan.height},
                {"shards", plan.shards},
                {"halo", plan.halo},
                {"lines", plan.lines},
                {"range_sigma", orNull(plan.range_sigma)},
                {"max_change", orNull(plan.max_change)},
                {"unit", plan.unit},
                {"revision", plan.revision}};
  report["one_file"] = plan.one_file.has_value();
  if (plan.one_file) {
    report["first_byte"] = plan.one_file->first_byte;
    report["file_bytes"] = plan.one_file->bytes;
  }
  return report;
}

}  // namespace

std::string hashOfText(const std::string& text) {
  return fmt::format("{:016x}", fnv(kFnvStart, text.data(), text.size()));
}

std::string ShardPlan::id() const {
  return hashOfText(identifying(*this).dump(-1, ' ', false, Report::error_handler_t::replace));
}

bool ShardPlan::inTurn() const {
  return std::ranges::find(arguments, "--shards-in-turn") != arguments.end();
}

bool writesPlainTiff(const std::string& out, const Report& settings) {
  const std::string extension = engine::extensionOf(out);
  return (extension == ".tif" || extension == ".tiff") && !settings.contains("cloud-optimised") &&
         settings.value("compress", 0) == static_cast<int>(engine::TiffCompression::kNone);
}

std::string planSchema(const std::string& command) {
  return fmt::format("fettle.plan.{}/1", command);
}

Report reportOf(const ShardPlan& plan) {
  Report report = identifying(plan);
  report["id"] = plan.id();
  report["arguments"] = plan.arguments;
  report["folder"] = plan.folder;
  report["seconds_per_shard"] = plan.seconds;
  report["memory_per_shard"] = plan.memory_bytes;
  report["threads"] = plan.threads;
  return report;
}

engine::Result<ShardPlan> readPlan(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file.is_open())
    return engine::inputError("there is no plan for these shards", path,
                              "make one first: fettle plan filter IN OUT ... --shards N");
  const Report report = Report::parse(file, nullptr, false);
  const auto refused = [&](const char* what) {
    return engine::inputError(what, path, "plan the work again");
  };
  if (!report.is_object() || !report.contains("command") || !report["command"].is_string())
    return refused("this is not a plan");
  if (report.value("schema", Report()) != planSchema(report["command"].get<std::string>()))
    return refused("the plan is of another version of fettle");
  try {
    ShardPlan plan;
    plan.command = report.at("command");
    plan.arguments = report.at("arguments").get<std::vector<std::string>>();
    plan.folder = report.at("folder");
    plan.settings = report.at("settings");
    plan.in = report.at("in");
    plan.out = report.at("out");
    plan.in_bytes = report.at("in_bytes");
    plan.in_print = report.at("in_print");
    plan.width = report.at("width");
    plan.height = report.at("height");
    plan.shards = report.at("shards");
    plan.halo = report.at("halo");
    plan.lines = report.at("lines");
    plan.range_sigma = numberOrNone(report.at("range_sigma"));
    plan.max_change = numberOrNone(report.at("max_change"));
    plan.unit = report.at("unit");
    plan.revision = report.at("revision");
    if (report.at("one_file").get<bool>())
      plan.one_file =
          engine::PlainLayout{plan.width, plan.height, report.at("first_byte").get<std::uint64_t>(),
                              report.at("file_bytes").get<std::uint64_t>()};
    plan.seconds = report.at("seconds_per_shard");
    plan.memory_bytes = report.at("memory_per_shard");
    plan.threads = report.value("threads", 1);  // older plans state none
    if (plan.id() != report.at("id")) return refused("the plan is damaged");
    if (plan.threads < 1 || plan.shards < 1 || plan.shards > engine::Grid::kMaxSide || plan.width < 1 ||
        plan.height < 1)
      return refused("the plan is damaged");
    if (plan.revision != engine::kFilterRevision)
      return refused("the plan is of a version of fettle whose filters have other results");
    return plan;
  } catch (const Report::exception&) {
    return refused("the plan is damaged");
  }
}

engine::Result<std::string> printOf(const std::string& path) {
  constexpr std::uint64_t kEnds = 64 << 10, kPiece = 4 << 10;
  constexpr int kPieces = 62;
  const auto file = engine::InputFile::open(path);
  if (!file) return tl::unexpected(file.error());
  std::string bytes(kEnds, '\0');
  std::uint64_t hash = kFnvStart;
  const auto add = [&](std::uint64_t offset, std::uint64_t size) -> engine::Status {
    const auto got = file->read(offset, bytes.data(), size);
    if (!got) return tl::unexpected(got.error());
    hash = fnv(hash, bytes.data(), *got);
    return {};
  };
  if (auto status = add(0, kEnds); !status) return tl::unexpected(status.error());
  for (int i = 1; i <= kPieces; ++i)
    if (auto status = add(file->size() / (kPieces + 1) * static_cast<std::uint64_t>(i), kPiece); !status)
      return tl::unexpected(status.error());
  if (auto status = add(file->size() > kEnds ? file->size() - kEnds : 0, kEnds); !status)
    return tl::unexpected(status.error());
  return fmt::format("{}-{:016x}", file->size(), hash);
}

}  // namespace fettle::app
