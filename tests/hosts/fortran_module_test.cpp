// The Fortran module: arrays without a copy, lists of nodes, parameters. Layouts are in
// python/test_bindings.py.
// SPDX-License-Identifier: BSD-3-Clause
#include "support/law_runner.hpp"
#include "support/matchers.hpp"
#include "support/small_batch.hpp"

#include <ilaw/ilaw.h>

#include <cstddef>
#include <cstdlib>
#include <iterator>
#include <string>
#include <vector>

extern "C" {
ilaw_batch fortran_default_batch();
ilaw_input fortran_input(int section, int bytes);
ilaw_output fortran_output(int section, int bytes);
ilaw_batch fortran_nodes(int width);
std::int32_t fortran_open_named(const char* name);
std::int32_t fortran_create(const char* library, int way, std::int32_t* per_node_count, char* message);
}

namespace {

using namespace ilaw::testing;
using namespace ilaw::testing::matchers;
TEST(FortranModule, DeclaredBatchIsEmptyAndCountsFromOne) {
  const ilaw_batch batch = fortran_default_batch();
  EXPECT_EQ(batch.index_base, 1);
  EXPECT_EQ(batch.node_count, 0);
  EXPECT_EQ(batch.index, nullptr);
  EXPECT_EQ(batch.index64, nullptr);
  EXPECT_EQ(batch.flags, 0U);
  for (const ilaw_input& input : {batch.v_free, batch.delassus, batch.gap, batch.gap_offset, batch.v_previous,
                                  batch.area, batch.normal, batch.tangent, batch.state_in})
    EXPECT_TRUE(!input.values && !input.floats);
  for (const ilaw_output& output : {batch.state_out, batch.impulse, batch.velocity, batch.energy})
    EXPECT_TRUE(!output.values && !output.floats);
  EXPECT_EQ(batch.status, nullptr);
}

double read(const ilaw_input& input, std::int64_t node, std::int64_t component) {
  const std::int64_t place = node * input.node_stride + component * input.component_stride;
  return input.values ? input.values[place] : input.floats[place];
}

// numbered(i,j) holds 10 i + j; i and j count from 1, nodes and components from 0.
struct section {
  int number;
  std::int64_t nodes, components;
  double first, per_node, per_component;

  friend void PrintTo(const section& shown, std::ostream* out) {
    *out << "section " << shown.number << ": " << shown.nodes << " nodes, " << shown.components
         << " components";
  }
};

class FortranArray : public testing::TestWithParam<section> {};

TEST_P(FortranArray, GoesInWithoutACopy) {
  const section& s = GetParam();
  for (const int bytes : {8, 4}) {
    const ilaw_input input = fortran_input(s.number, bytes);
    ASSERT_TRUE(bytes == 8 ? input.values && !input.floats : input.floats && !input.values) << bytes;
    for (std::int64_t node = 0; node < s.nodes; ++node)
      for (std::int64_t component = 0; component < s.components; ++component)
        EXPECT_EQ(read(input, node, component), s.first + s.per_node * static_cast<double>(node) +
                                                    s.per_component * static_cast<double>(component))
            << "node " << node << ", component " << component << ", numbers of " << bytes << " bytes";
  }
}

INSTANTIATE_TEST_SUITE_P(Sections, FortranArray,
                         testing::Values(section{0, 9, 8, 11, 1, 10},    // (8,9)
                                         section{1, 8, 9, 11, 10, 1},    // (8,9), nodes first
                                         section{2, 9, 3, 41, 1, 10},    // (4:6,:)
                                         section{3, 3, 4, 29, -3, 20},   // (2:8:2, 9:1:-3)
                                         section{4, 9, 1, 1, 1, 0},      // line
                                         section{5, 9, 1, 31, 1, 0},     // (3,:)
                                         section{6, 5, 3, 25, 0, 10},    // (2:4,5) for all
                                         section{7, 1, 3, 47, 0, 10}));  // (4:6,7:7)

TEST(FortranModule, EmptyArrayIsAbsent) {
  for (const int bytes : {8, 4}) {
    const ilaw_input input = fortran_input(8, bytes);
    EXPECT_TRUE(!input.values && !input.floats);
  }
}

TEST(FortranModule, OutputsAreTheArraysThatInputsAre) {
  const int same_as_input[] = {0, 1, 4};
  for (const int bytes : {8, 4})
    for (int section = 0; section < 3; ++section) {
      const ilaw_output output = fortran_output(section, bytes);
      const ilaw_input input = fortran_input(same_as_input[section], bytes);
      EXPECT_EQ(output.values, input.values) << "section " << section;
      EXPECT_EQ(output.floats, input.floats) << "section " << section;
      EXPECT_EQ(output.node_stride, input.node_stride) << "section " << section;
      EXPECT_EQ(output.component_stride, input.component_stride) << "section " << section;
    }
}

TEST(FortranModule, ListsNodesInBothWidths) {
  const ilaw_batch narrow = fortran_nodes(4), wide = fortran_nodes(8), none = fortran_nodes(0);
  ASSERT_NE(narrow.index, nullptr);
  ASSERT_NE(wide.index64, nullptr);
  EXPECT_EQ(narrow.index64, nullptr);
  EXPECT_EQ(wide.index, nullptr);
  EXPECT_EQ(none.index, nullptr);
  EXPECT_EQ(none.index64, nullptr);
  EXPECT_EQ(none.node_count, 0);
  for (const ilaw_batch& batch : {narrow, wide}) EXPECT_EQ(batch.node_count, 3);
  EXPECT_EQ(std::vector<std::int32_t>(narrow.index, narrow.index + 3), (std::vector<std::int32_t>{3, 1, 7}));
  EXPECT_EQ(std::vector<std::int64_t>(wide.index64, wide.index64 + 3), (std::vector<std::int64_t>{3, 1, 7}));
}

TEST(FortranModule, OpensByNameAlone) {
  setenv("ILAW_PATH", ILAW_PLUGIN_FOLDER, 1);
  EXPECT_EQ(fortran_open_named("coulomb"), ILAW_OK);
  EXPECT_EQ(fortran_open_named(ILAW_PLUGIN_FOLDER "/coulomb.so"), ILAW_NOT_FOUND);
}

struct creation {
  std::int32_t code, per_node_count;
  std::string message;
};

creation create(int way, const char* library = ILAW_PLUGIN_FOLDER "/coulomb.so") {
  creation made;
  char message[200];
  made.code = fortran_create(library, way, &made.per_node_count, message);
  made.message.assign(message, sizeof message);
  made.message.erase(made.message.find_last_not_of(' ') + 1);
  return made;
}

TEST(FortranModule, PassesEveryKindOfParameterValue) {
  EXPECT_EQ(create(0).message, "");
  EXPECT_EQ(create(0).code, ILAW_OK);
  EXPECT_EQ(create(3).message, "");  // a table
  EXPECT_EQ(create(3).code, ILAW_OK);
  EXPECT_EQ(create(3).per_node_count, 0);
  EXPECT_EQ(create(5).message, "");  // one value per node
  EXPECT_EQ(create(5).code, ILAW_OK);
  EXPECT_EQ(create(5).per_node_count, 1);
}

TEST(FortranModule, HandsOverWhyAParameterIsRefused) {
  const creation negative = create(1);
  EXPECT_EQ(negative.code, ILAW_INVALID_PARAMETER);
  EXPECT_THAT(negative.message, HasSubstr("friction"));
  EXPECT_THAT(negative.message, HasSubstr("-2"));
  const creation choice = create(2);
  EXPECT_EQ(choice.code, ILAW_INVALID_PARAMETER);
  EXPECT_THAT(choice.message, HasSubstr("sometimes"));
  EXPECT_THAT(choice.message, HasSubstr("predictive"));
  const creation none = create(7);
  EXPECT_EQ(none.code, ILAW_INVALID_PARAMETER);
  EXPECT_THAT(none.message, HasSubstr("friction"));
  const creation table = create(4);
  EXPECT_EQ(table.code, ILAW_INVALID_PARAMETER);
  EXPECT_THAT(table.message, HasSubstr("friction"));
}

TEST(FortranModule, RefusesAForgottenFrame) { EXPECT_EQ(create(8).code, ILAW_UNSUPPORTED); }

TEST(FortranModule, HandsOverWhyALibraryOrLawIsNotFound) {
  const creation law = create(6);
  EXPECT_EQ(law.code, ILAW_NOT_FOUND);
  EXPECT_THAT(law.message, HasSubstr("absent"));
  EXPECT_THAT(law.message, HasSubstr("coulomb"));
  const creation library = create(0, "/no/such/library.so");
  EXPECT_EQ(library.code, ILAW_NOT_FOUND);
  EXPECT_THAT(library.message, HasSubstr("/no/such/library.so"));
}

}  // namespace
