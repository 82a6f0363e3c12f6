// One scan in shards: the file of one run, whatever the number; what is missing or wrong is named.

#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>
#include <csignal>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <cpl_error.h>
#include <gdal.h>
#include <gtest/gtest.h>

#include "tests/end_to_end/program.h"
#include "tests/support/temp_folder.h"

namespace fettle::tests {
namespace {

using Words = std::vector<std::string>;
namespace fs = std::filesystem;

std::string contentOf(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

Words operator+(Words words, const Words& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

class Shards : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(fettle({"synth", scan(), "--size", "96x330", "--part", "steps"}).status, 0);
  }
  [[nodiscard]] std::string file(const std::string& name) const { return folder_.file(name); }
  [[nodiscard]] std::string scan() const { return file("scan.tif"); }
  [[nodiscard]] std::string out() const { return file("out.tif"); }
  [[nodiscard]] std::string folder() const { return out() + ".shards"; }

  // Plans, does and gathers; the report of gathering.
  nlohmann::json inShards(const Words& filter, int n, const Words& plan_options = {}) {
    const std::string count = std::to_string(n);
    (void)fettleJson(Words{"plan", "filter", scan(), out(), "--shards", count} + filter + plan_options);
    // In another order than that of the rows.
    for (int k = n; k >= 1; --k) {
      const auto shard = fettleJson(Words{"filter", scan(), out()} + filter +
                                    Words{"--shard", std::to_string(k) + "/" + count});
      EXPECT_EQ(shard["shard"], k);
    }
    return fettleJson({"gather", out()});
  }

  TempFolder folder_;
};

TEST_F(Shards, AnyNumberOfThemMakesTheFileOfOneRunByteByByte) {
  // Every filter: tests/engine/shard.
  const Words filter{"--filter", "median", "--window", "5", "--max-change", "50um"};
  const auto whole = fettleJson(Words{"filter", scan(), file("whole.tif")} + filter);
  for (const int n : {1, 2, 3, 7}) {
    const auto report = inShards(filter, n, n == 3 ? Words{"--result", "files"} : Words{});
    EXPECT_EQ(report["hash"], whole["hash"]);
    EXPECT_EQ(report["changed"], whole["changed"]);
    EXPECT_EQ(report["max_change"], whole["max_change"]);
    EXPECT_TRUE(contentOf(out()) == contentOf(file("whole.tif"))) << n << " shards";
    EXPECT_FALSE(fs::exists(folder()));
    fs::remove(out());
  }
}

TEST_F(Shards, OfMachinesWithOtherProcessorsHaveTheSameBits) {
  const Words filter{"--filter", "planes"};  // its range is the noise's
  (void)fettleJson(Words{"filter", scan(), file("whole.tif")} + filter);
  (void)fettleJson(Words{"plan", "filter", scan(), out(), "--shards", "3"} + filter);
  const Words levels{"plain", "avx2", "avx512"};  // as far as this processor has them
  for (std::size_t k = 0; k < levels.size(); ++k)
    EXPECT_EQ(runProcess(Words{"env", "FETTLE_CPU=" + levels[k], FETTLE_PROGRAM, "filter", scan(), out()} +
                         filter + Words{"--shard", std::to_string(k + 1)})
                  .status,
              0);
  (void)fettleJson({"gather", out()});
  EXPECT_TRUE(contentOf(out()) == contentOf(file("whole.tif")));
}

TEST_F(Shards, MarksLinesAndOtherFormatsGoAsWell) {
  ASSERT_EQ(fettle({"mark", scan(), file("m.png"), "--edges", "--lines-out", file("l.csv")}).status, 0);
  for (const Words& filter : {Words{"--filter", "median", "--keep", file("m.png")},
                              Words{"--filter", "gaussian", "--window", "7", "--lines", file("l.csv")}}) {
    (void)fettleJson(Words{"filter", scan(), file("whole.tif")} + filter);
    inShards(filter, 3);
    EXPECT_TRUE(contentOf(out()) == contentOf(file("whole.tif"))) << filter[1];
    fs::remove(out());
  }
  ASSERT_EQ(fettle({"convert", scan(), file("scan.x3p")}).status, 0);
  for (const char* to : {"o.asc", "o.x3p"}) {
    const Words filter{"filter", file("scan.x3p"), file(to), "--filter", "box"};
    (void)fettleJson(Words{"filter", file("scan.x3p"), file(std::string("whole.") + to), "--filter", "box"});
    (void)fettleJson(Words{"plan"} + filter + Words{"--shards", "2"});
    (void)fettleJson(filter + Words{"--shard", "1"});
    (void)fettleJson(filter + Words{"--shard", "2"});
    (void)fettleJson({"gather", file(to)});
    EXPECT_EQ(fettleJson({"compare", file(to), file(std::string("whole.") + to)})["max_abs"], 0.0) << to;
  }
}

TEST_F(Shards, ConvertedInShardsTheSamplesStay) {
  const Words convert{"convert", scan(), out(), "--compress", "deflate"};
  (void)fettleJson({"convert", scan(), file("whole.tif"), "--compress", "deflate"});
  (void)fettleJson(Words{"plan"} + convert + Words{"--shards", "2"});
  (void)fettleJson(convert + Words{"--shard", "1"});
  (void)fettleJson(convert + Words{"--shard", "2"});
  (void)fettleJson({"gather", out()});
  EXPECT_TRUE(contentOf(out()) == contentOf(file("whole.tif")));
}

TEST_F(Shards, WhatIsMissingOrDamagedIsNamedAndDoneAgain) {
  const Words filter{"filter", scan(), out(), "--filter", "box"};
  for (const std::string result : {"one-file", "files"}) {
    (void)fettleJson(Words{"plan"} + filter + Words{"--shards", "5", "--result", result});
    for (const char* k : {"1", "4"}) (void)fettleJson(filter + Words{"--shard", k});
    expectFailed(fettle({"gather", out()}), "3 of 5 shards are not done: 2, 3 and 5");
    EXPECT_FALSE(fs::exists(out()));
    const auto status = fettleJson({"status", out()});
    EXPECT_EQ(status["done"], nlohmann::json({1, 4}));
    EXPECT_EQ(status["waiting"], nlohmann::json({2, 3, 5}));
    EXPECT_EQ(fettle({"status", out()}).out, "2 of 5 shards done, 3 waiting: 2, 3 and 5\n");
    for (const char* k : {"2", "3", "5"}) (void)fettleJson(filter + Words{"--shard", k});
    // One is not done twice.
    EXPECT_EQ(fettleJson(filter + Words{"--shard", "2"})["finished_before"], true);
    // A sample of the rows of shard 3.
    const std::string rows = folder() + (result == "files" ? "/rows-3.tif" : "/whole.tif");
    std::fstream damaged(rows, std::ios::in | std::ios::out | std::ios::binary);
    damaged.seekp(static_cast<std::streamoff>(fs::file_size(rows)) - 4 * 96 * (result == "files" ? 10 : 140));
    damaged.write("oh", 2);
    damaged.close();
    expectFailed(fettle({"gather", out()}), "the rows of shard 3 of 5 are not what it wrote");
    EXPECT_FALSE(fettleJson(filter + Words{"--shard", "3"}).contains("finished_before"));
    (void)fettleJson({"gather", out()});
    (void)fettleJson({"filter", scan(), file("whole.tif"), "--filter", "box"});
    EXPECT_TRUE(contentOf(out()) == contentOf(file("whole.tif")));
    fs::remove(out());
  }
}

TEST_F(Shards, KilledAtAnyMomentOneIsDoneAgainAndTheOthersStay) {
  const Words filter{"filter", scan(), out(), "--filter", "tgv", "--threads", "1"};
  (void)fettleJson({"filter", scan(), file("whole.tif"), "--filter", "tgv", "--compute", "cpu"});
  (void)fettleJson(Words{"plan"} + filter + Words{"--shards", "2"});
  (void)fettleJson(filter + Words{"--shard", "1"});
  ProcessOptions kill_it;
  kill_it.while_running = [&](int pid) {
    if (!fs::exists(folder() + "/running-2.json")) return false;
    kill(pid, SIGKILL);
    return true;
  };
  Words second = filter + Words{"--shard", "2"};
  EXPECT_NE(fettle(second, kill_it).status, 0);
  expectFailed(fettle({"gather", out()}), "1 of 2 shards is not done: 2");
  (void)fettleJson(second);
  (void)fettleJson({"gather", out()});
  EXPECT_TRUE(contentOf(out()) == contentOf(file("whole.tif")));
}

TEST_F(Shards, AFullDiskOfOneLeavesTheOthersAndThePlan) {
  const Words filter{"filter", scan(), out(), "--filter", "box"};
  (void)fettleJson(Words{"plan"} + filter + Words{"--shards", "2", "--result", "files"});
  (void)fettleJson(filter + Words{"--shard", "1"});
  ProcessOptions full;
  full.file_limit = 20000;  // a band has 96 x 138 x 4 bytes and more
  expectFailed(fettle(filter + Words{"--shard", "2"}, full), "limit on file sizes");
  EXPECT_EQ(fettleJson({"status", out()})["done"], nlohmann::json({1}));
  for (const auto& entry : fs::directory_iterator(folder()))
    EXPECT_EQ(entry.path().filename().string().find("part-"), std::string::npos) << entry.path();
  (void)fettleJson(filter + Words{"--shard", "2"});
  (void)fettleJson({"gather", out()});
}

TEST_F(Shards, AreGatheredFromAnotherFolderThroughALinkWithThePermissionsOfWhatWasThere) {
  (void)fettleJson({"filter", scan(), file("whole.tif"), "--filter", "box"});
  ASSERT_EQ(mkdir(file("elsewhere").c_str(), 0755), 0);
  ASSERT_EQ(mkdir(file("target").c_str(), 0755), 0);
  std::ofstream(file("elsewhere/out.tif")) << "not to be touched";
  // Planned and done in the folder of the scan, by names from there.
  ProcessOptions here, elsewhere;
  here.folder = folder_.path().string();
  elsewhere.folder = file("elsewhere");
  for (const std::string result : {"one-file", "files"}) {
    std::ofstream(file("target/real.tif")) << "old";
    ASSERT_EQ(chmod(file("target/real.tif").c_str(), 0640), 0);
    fs::create_symlink("target/real.tif", out());
    const Words filter{"filter", "scan.tif", "out.tif", "--filter", "box"};
    ASSERT_EQ(fettle(Words{"plan"} + filter + Words{"--shards", "2", "--result", result}, here).status, 0);
    for (const char* k : {"1", "2"}) ASSERT_EQ(fettle(filter + Words{"--shard", k}, here).status, 0);
    const Outcome gathered = fettle({"gather", out()}, elsewhere);
    ASSERT_EQ(gathered.status, 0) << gathered.err;
    EXPECT_TRUE(contentOf(file("target/real.tif")) == contentOf(file("whole.tif"))) << result;
    EXPECT_TRUE(fs::is_symlink(out()));
    EXPECT_EQ(fs::status(file("target/real.tif")).permissions(), fs::perms{0640});
    EXPECT_EQ(contentOf(file("elsewhere/out.tif")), "not to be touched");
    fs::remove(out());
  }
}

TEST_F(Shards, RowsThatTheSystemDoesNotOpenNowAreNotCalledDamaged) {
  const Words filter{"filter", scan(), out(), "--filter", "box"};
  (void)fettleJson(Words{"plan"} + filter + Words{"--shards", "2", "--result", "files"});
  for (const char* k : {"1", "2"}) (void)fettleJson(filter + Words{"--shard", k});
  // For a limit on open files, or a server that is away, stands a socket: open(2) refuses it, whoever asks.
  const std::string rows = folder() + "/rows-2.tif";
  fs::rename(rows, file("kept.tif"));
  sockaddr_un name{};
  name.sun_family = AF_UNIX;
  ASSERT_LT(rows.size(), sizeof name.sun_path);
  std::copy(rows.begin(), rows.end(), name.sun_path);
  const int socket_here = socket(AF_UNIX, SOCK_STREAM, 0);
  ASSERT_EQ(bind(socket_here, reinterpret_cast<const sockaddr*>(&name), sizeof name), 0);
  expectFailed(fettle({"gather", out()}), "the file cannot be opened");
  close(socket_here);
  fs::remove(rows);
  fs::rename(file("kept.tif"), rows);
  EXPECT_EQ(fettleJson({"status", out()})["done"], nlohmann::json({1, 2}));
  (void)fettleJson({"gather", out()});
}

TEST_F(Shards, ContradictionsAreRefused) {
  const Words filter{"filter", scan(), out(), "--filter", "tv"};
  expectRefused(fettle(filter + Words{"--shard", "1/2"}), "there is no plan");
  expectRefused(fettle({"gather", out()}), "there is no plan");
  for (const char* whole : {"spline", "robust-spline", "robust-gaussian"})
    expectRefused(
        fettle({"plan", "filter", scan(), out(), "--filter", whole, "--cutoff", "2", "--shards", "2"}),
        "depends on the whole field");
  (void)fettleJson(
      {"plan", "filter", scan(), file("one.tif"), "--filter", "spline", "--cutoff", "2", "--shards", "1"});
  (void)fettleJson(Words{"plan"} + filter + Words{"--shards", "2"});
  expectRefused(fettle(filter + Words{"--shard", "0/2"}), "there is no shard 0 of 2");
  expectRefused(fettle(filter + Words{"--shard", "3/2"}), "there is no shard 3 of 2");
  expectRefused(fettle(filter + Words{"--shard", "1/3"}), "planned for 2");
  expectRefused(fettle(filter + Words{"--shard", "two"}), "is not a shard");
  expectRefused(fettle(filter + Words{"--shard", "auto"}), "no launcher");
  expectRefused(fettle(filter + Words{"--shard", "1", "--window", "9"}), "planned with window 3, not with 9");
  expectRefused(fettle(filter + Words{"--shard", "1", "--shards-in-turn"}), "contradict");
  expectRefused(fettle(filter + Words{"--memory", "1GB"}), "add --shards-in-turn");
  expectRefused(fettle(filter + Words{"--shard", "1", "--residual", file("r.tif")}),
                "not divided into shards");
  expectRefused(fettle(Words{"plan"} + filter + Words{"--shards", "4"}), "there is another plan");
  expectRefused(fettle({"plan", "filter", scan(), file("o.fettle"), "--filter", "box", "--shards", "2"}),
                "session");
  // The same plan again changes nothing.
  (void)fettleJson(filter + Words{"--shard", "1"});
  (void)fettleJson(Words{"plan"} + filter + Words{"--shards", "2"});
  EXPECT_EQ(fettleJson({"status", out()})["done"], nlohmann::json({1}));
  // Another input under the same name.
  ASSERT_EQ(fettle({"synth", scan(), "--size", "96x330", "--seed", "9"}).status, 0);
  expectRefused(fettle(filter + Words{"--shard", "2"}), "not the file that the work was planned for");
}

TEST_F(Shards, AreNumberedByTheirLauncher) {
  const Words filter{"filter", scan(), out(), "--filter", "box", "--shard", "auto"};
  (void)fettleJson({"plan", "filter", scan(), out(), "--filter", "box", "--shards", "3"});
  const auto shardWith = [&](const Words& variables) {
    return runProcess(Words{"env"} + variables + Words{FETTLE_PROGRAM} + filter + Words{"--json"});
  };
  const std::vector<std::pair<Words, int>> launchers{
      {{"SLURM_ARRAY_TASK_ID=5", "SLURM_ARRAY_TASK_COUNT=3", "SLURM_ARRAY_TASK_MIN=3", "SLURM_PROCID=0",
        "SLURM_NTASKS=1"},
       3},
      {{"SLURM_ARRAY_TASK_ID=1", "SLURM_ARRAY_TASK_COUNT=3", "SLURM_ARRAY_TASK_MIN=1"}, 1},
      {{"OMPI_COMM_WORLD_RANK=1", "OMPI_COMM_WORLD_SIZE=3", "PMI_RANK=1", "PMI_SIZE=3"}, 2},
      {{"SLURM_PROCID=2", "SLURM_NTASKS=3"}, 3}};
  for (const auto& [variables, number] : launchers) {
    const Outcome outcome = shardWith(variables);
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(nlohmann::json::parse(outcome.out)["shard"], number) << variables[0];
  }
  expectRefused(runProcess({"env", "PMI_RANK=1", FETTLE_PROGRAM, "filter", scan(), out(), "--filter", "box",
                            "--shard", "auto"}),
                "PMI_SIZE is not set");
  expectRefused(runProcess({"env", "SLURM_ARRAY_TASK_ID=1", "SLURM_ARRAY_TASK_COUNT=3",
                            "SLURM_ARRAY_TASK_MIN=1", "PMI_RANK=1", "PMI_SIZE=3", FETTLE_PROGRAM, "filter",
                            scan(), out(), "--filter", "box", "--shard", "auto"}),
                "MPI says 2 of 3");
  expectRefused(runProcess({"env", "PMI_RANK=7", "PMI_SIZE=3", FETTLE_PROGRAM, "filter", scan(), out(),
                            "--filter", "box", "--shard", "auto"}),
                "7 of 3 tasks is none");
}

// The samples of a raster as GDAL has them, the highest row first; its geotransform behind them.
std::vector<double> readByGdal(const std::string& path) {
  GDALAllRegister();
  std::vector<double> out;
  const GDALDatasetH raster = GDALOpen(path.c_str(), GA_ReadOnly);
  EXPECT_NE(raster, nullptr) << CPLGetLastErrorMsg();
  if (raster == nullptr) return out;
  const int width = GDALGetRasterXSize(raster), height = GDALGetRasterYSize(raster);
  out.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) + 6);
  EXPECT_EQ(GDALRasterIO(GDALGetRasterBand(raster, 1), GF_Read, 0, 0, width, height, out.data(), width,
                         height, GDT_Float64, 0, 0),
            CE_None);
  EXPECT_EQ(GDALGetGeoTransform(raster, out.data() + out.size() - 6), CE_None);
  GDALClose(raster);
  return out;
}

TEST_F(Shards, AVirtualRasterOverTheFilesOfTheShardsIsForGdalTheResultOfOneRun) {
  const Words filter{"filter", scan(), out(), "--filter", "box"};
  (void)fettleJson(Words{"plan"} + filter + Words{"--shards", "3", "--result", "files"});
  for (const char* k : {"1", "2", "3"}) (void)fettleJson(filter + Words{"--shard", k});
  (void)fettleJson({"gather", out(), "--vrt", file("out.vrt")});
  EXPECT_FALSE(fs::exists(out()));
  (void)fettleJson({"filter", scan(), file("whole.tif"), "--filter", "box"});
  const std::vector<double> whole = readByGdal(file("whole.tif")), together = readByGdal(file("out.vrt"));
  ASSERT_EQ(whole.size(), 96U * 330U + 6U);
  ASSERT_EQ(together.size(), whole.size());
  for (std::size_t i = 0; i < whole.size() - 6; ++i)
    ASSERT_TRUE(together[i] == whole[i] || (std::isnan(together[i]) && std::isnan(whole[i]))) << i;
  // The corner is a sum of the band's origin and rows, in another order.
  for (std::size_t i = whole.size() - 6; i < whole.size(); ++i) EXPECT_NEAR(together[i], whole[i], 1e-9);
}

TEST_F(Shards, SubmitPrintsAJobAndRunsItHere) {
  const Words filter{"filter", scan(), out(), "--filter", "box"};
  (void)fettleJson(Words{"plan"} + filter + Words{"--shards", "3"});
  // What is printed takes the threads for which time and memory are foreseen.
  const Outcome again = fettle(Words{"plan"} + filter + Words{"--shards", "3"});
  EXPECT_NE(again.out.find("--filter box --threads 1 --shard K/3"), std::string::npos) << again.out;
  expectFailed(fettle({"gather", out()}), "--filter box --threads 1 --shard K/3");
  const std::string slurm = fettle({"submit", out(), "--engine", "slurm", "--at-once", "2"}).out;
  EXPECT_NE(slurm.find("--array=1-3%2 --cpus-per-task=1"), std::string::npos) << slurm;
  EXPECT_NE(slurm.find("--dependency=afterany"), std::string::npos);
  EXPECT_NE(slurm.find("--shard auto"), std::string::npos);
  // Of more shards than a site's arrays have tasks each does several.
  const std::string few = fettle({"submit", out(), "--engine", "slurm", "--tasks", "2"}).out;
  EXPECT_NE(few.find("--array=1-2 "), std::string::npos) << few;
  EXPECT_NE(few.find("for k in $(seq $SLURM_ARRAY_TASK_ID 2 3)"), std::string::npos) << few;
  const std::string mpi = fettle({"submit", out(), "--engine", "mpi", "--with", "--oversubscribe"}).out;
  EXPECT_NE(mpi.find("mpirun -n 3 --oversubscribe "), std::string::npos) << mpi;
  const Outcome run = fettle({"submit", out(), "--engine", "local", "--run"});
  EXPECT_EQ(run.status, 0) << run.err;
  (void)fettleJson({"filter", scan(), file("whole.tif"), "--filter", "box"});
  EXPECT_TRUE(contentOf(out()) == contentOf(file("whole.tif")));
}

TEST_F(Shards, SubmitAsksForTheThreadsThatShardsRunWith) {
  const Words filter{"filter", scan(), out(), "--filter", "median"};
  (void)fettleJson(Words{"plan"} + filter + Words{"--shards", "2", "--threads", "2"});
  const auto planned = fettleJson({"submit", out(), "--engine", "slurm"});
  EXPECT_EQ(planned["threads"], 2);
  const auto more = fettleJson({"submit", out(), "--engine", "slurm", "--threads", "4"});
  EXPECT_EQ(more["threads"], 4);
  EXPECT_GT(more["memory_per_shard"], planned["memory_per_shard"]);
  const std::string script = more["script"];
  EXPECT_NE(script.find("--cpus-per-task=4"), std::string::npos) << script;
  EXPECT_NE(script.find(" --threads 4 --shard auto"), std::string::npos) << script;
  EXPECT_EQ(script.find("--threads 2"), std::string::npos) << script;
  // One processor less takes longer.
  EXPECT_GE(fettleJson({"submit", out(), "--engine", "slurm", "--threads", "1"})["seconds_per_shard"],
            planned["seconds_per_shard"]);
}

TEST_F(Shards, ANameThatAShellReadsOtherwiseStaysAName) {
  // A line break would be a command of the script's own, % and braces would be replaced.
  const std::string odd = file("100%a {} of\ntouch pwned \"it's\".tif");
  ProcessOptions here;
  here.folder = folder_.path().string();
  const Words filter{"filter", scan(), odd, "--filter", "box"};
  const Outcome planned = fettle(Words{"plan"} + filter + Words{"--shards", "3"}, here);
  ASSERT_EQ(planned.status, 0) << planned.err;
  EXPECT_NE(planned.out.find("'\\''"), std::string::npos) << planned.out;
  const std::string slurm = fettle({"submit", odd, "--engine", "slurm"}).out;
  EXPECT_NE(slurm.find("100%%a {} of"), std::string::npos) << slurm;
  const Outcome run = fettle({"submit", odd, "--engine", "local", "--run"}, here);
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_FALSE(fs::exists(file("pwned")));
  (void)fettleJson({"filter", scan(), file("whole.tif"), "--filter", "box"});
  EXPECT_TRUE(contentOf(odd) == contentOf(file("whole.tif")));
}

TEST_F(Shards, WhatIsReadOrWrittenAsAWholeTakesMoreMemoryOfShardsOrOfGathering) {
  ASSERT_EQ(fettle({"synth", file("big.tif"), "--size", "2000x2000"}).status, 0);
  const auto memory = [&](const std::string& name, const Words& more) {
    return fettleJson(
               Words{"plan", "filter", file("big.tif"), file(name), "--filter", "box", "--shards", "8"} +
               more)["memory_per_shard"]
        .get<double>();
  };
  const double plain = memory("a.tif", {});
  EXPECT_GE(memory("b.tif", {"--original", file("big.tif"), "--max-change", "1um"}), plain + 2 * 4.0 * 4e6);
  const std::string tiff = fettle({"submit", file("a.tif"), "--engine", "slurm"}).out;
  (void)memory("c.asc", {});
  const std::string text = fettle({"submit", file("c.asc"), "--engine", "slurm"}).out;
  const auto asked = [](const std::string& script) {
    return std::stoi(script.substr(script.rfind("--mem=") + 6));
  };
  EXPECT_GE(asked(tiff), 150);
  EXPECT_GE(asked(text), asked(tiff) + 16);
}

}  // namespace
}  // namespace fettle::tests
