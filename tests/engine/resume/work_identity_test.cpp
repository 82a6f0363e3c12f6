#include "engine/resume/work_identity.h"

#include <cstdint>
#include <map>
#include <string_view>

#include <gtest/gtest.h>

#include "engine/filter/catalogue.h"
#include "tests/engine/resume/scan.h"

namespace fettle::engine {
namespace {

// Work kept by one version of the program is continued by the next: if a filter's bits change, so must the revision.
TEST(FilterRevision, IsRaisedWhenTheBitsOfAnyFilterChange) {
  ASSERT_EQ(kFilterRevision, 2) << "enter the hashes of the new revision";
  const std::map<std::string_view, std::uint64_t> hashes{{"box", 0xd559f1db0d8fd2f8},
                                                         {"gaussian", 0x0f1f7ad2ce0ba8bf},
                                                         {"median", 0x11b24cbfe7f5878c},
                                                         {"bilateral", 0xd1b0127cbb592737},
                                                         {"tv", 0x79c5eddeb71525a3},
                                                         {"tgv", 0x4b5f30f22bf2dd30},
                                                         {"planes", 0x431bb46cc050bf4a},
                                                         {"areal-gaussian", 0x1a70be18ea45fe5b},
                                                         {"robust-gaussian", 0x701d7dc29311338a},
                                                         {"opening", 0xf42c1e8dbc0f2391},
                                                         {"closing", 0x29f8879b37723d88},
                                                         {"spline", 0x9b97aa90ccba80c2},
                                                         {"robust-spline", 0x5bb2aa7e3bff60c9},
                                                         {"outliers", 0x79007aae0759f746}};
  const Version scan = scanWithEverything(330, 290);
  for (const Filter& filter : filters()) {
    JobControl job;
    const auto filtered = applyFilter(scan, scan, specFor(filter.kind, 2, 0), job);
    ASSERT_TRUE(filtered);
    ASSERT_TRUE(hashes.contains(filter.word));
    EXPECT_EQ(contentHash(filtered->field), hashes.at(filter.word))
        << filter.word << ": the bits have changed, raise kFilterRevision; now " << std::hex
        << contentHash(filtered->field);
  }
}

TEST(WorkIdentity, NamesTheFirstPartThatDiffers) {
  const WorkIdentity id{{{"revision", "1"}, {"scan", "a"}}};
  EXPECT_EQ(id.differsIn(id.text()), "");
  EXPECT_EQ(id.differsIn("revision 1\nscan b\n"), "scan");
  EXPECT_EQ(id.differsIn("revision 1\n"), "scan");
  EXPECT_EQ(id.differsIn("revision 1\nscan a\noriginal c\n"), "original");
  EXPECT_EQ(id.differsIn(""), "revision");
}

}  // namespace
}  // namespace fettle::engine
