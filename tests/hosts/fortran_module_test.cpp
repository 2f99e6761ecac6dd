// The Fortran module against the C header: layout, constants, arrays without a copy, parameters.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <enumerators.hpp>

#include <cstddef>
#include <cstdlib>
#include <iterator>
#include <string>
#include <vector>

extern "C" {
int fortran_layout_of(int structure, std::int64_t* layout);
void fortran_struct_sizes(std::int32_t* sizes);
ilaw_batch fortran_default_batch();
void fortran_enumerators(std::int32_t* values);
ilaw_input fortran_input(int section);
ilaw_output fortran_output(int section);
ilaw_batch fortran_nodes(int width);
std::int32_t fortran_open_named(const char* name);
std::int32_t fortran_create(const char* library, int way, std::int32_t* per_node_count, char* message);
}

namespace {

using layout = std::vector<std::int64_t>;

// Size of a struct and the offsets of its members, in C.
#define OFFSET(member) offsetof(T, member)

layout parameter_layout() {
  using T = ilaw_parameter;
  return {sizeof(T),
          OFFSET(struct_size),
          OFFSET(kind),
          OFFSET(name),
          OFFSET(symbol),
          OFFSET(unit),
          OFFSET(doc),
          OFFSET(minimum),
          OFFSET(maximum),
          OFFSET(default_value),
          OFFSET(required),
          OFFSET(minimum_excluded),
          OFFSET(infinity_allowed),
          OFFSET(may_be),
          OFFSET(choices),
          OFFSET(choice_count),
          OFFSET(reserved)};
}

layout state_variable_layout() {
  using T = ilaw_state_variable;
  return {sizeof(T),   OFFSET(struct_size), OFFSET(kind),  OFFSET(name),    OFFSET(unit),
          OFFSET(doc), OFFSET(count),       OFFSET(flags), OFFSET(reserved)};
}

layout argument_layout() {
  using T = ilaw_argument;
  return {sizeof(T),      OFFSET(struct_size), OFFSET(kind),   OFFSET(name),
          OFFSET(number), OFFSET(text),        OFFSET(values), OFFSET(count)};
}

layout setup_layout() {
  using T = ilaw_setup;
  return {sizeof(T),     OFFSET(struct_size), OFFSET(dimension),      OFFSET(delassus_form), OFFSET(frame),
          OFFSET(flags), OFFSET(arguments),   OFFSET(argument_count), OFFSET(has_tangent)};
}

layout info_layout() {
  using T = ilaw_instance_info;
  return {sizeof(T),
          OFFSET(struct_size),
          OFFSET(inputs),
          OFFSET(balance_inputs),
          OFFSET(state_variable_count),
          OFFSET(state_size),
          OFFSET(state_variables),
          OFFSET(per_node_parameters),
          OFFSET(per_node_parameter_count),
          OFFSET(capabilities),
          OFFSET(state_version),
          OFFSET(reserved)};
}

layout input_layout() {
  using T = ilaw_input;
  return {sizeof(T), OFFSET(values), OFFSET(node_stride), OFFSET(component_stride)};
}

layout output_layout() {
  using T = ilaw_output;
  return {sizeof(T), OFFSET(values), OFFSET(node_stride), OFFSET(component_stride)};
}

layout batch_layout() {
  using T = ilaw_batch;
  return {sizeof(T),
          OFFSET(struct_size),
          OFFSET(index_base),
          OFFSET(flags),
          OFFSET(node_count),
          OFFSET(index),
          OFFSET(index64),
          OFFSET(time),
          OFFSET(velocity_step),
          OFFSET(position_step),
          OFFSET(v_free),
          OFFSET(delassus),
          OFFSET(gap),
          OFFSET(gap_offset),
          OFFSET(v_previous),
          OFFSET(area),
          OFFSET(normal),
          OFFSET(tangent),
          OFFSET(per_node_parameters),
          OFFSET(state_in),
          OFFSET(state_out),
          OFFSET(impulse),
          OFFSET(velocity),
          OFFSET(energy),
          OFFSET(status),
          OFFSET(status_stride)};
}

layout report_layout() {
  using T = ilaw_report;
  return {sizeof(T),
          OFFSET(struct_size),
          OFFSET(reserved),
          OFFSET(bad_count),
          OFFSET(first_bad_node),
          OFFSET(reason),
          OFFSET(stable_velocity_step)};
}

layout law_layout() {
  using T = ilaw_law;
  return {sizeof(T),
          OFFSET(struct_size),
          OFFSET(dimensions),
          OFFSET(delassus_forms),
          OFFSET(inputs),
          OFFSET(outputs),
          OFFSET(capabilities),
          OFFSET(id),
          OFFSET(title),
          OFFSET(doc),
          OFFSET(references),
          OFFSET(parameters),
          OFFSET(state_variables),
          OFFSET(reference_count),
          OFFSET(parameter_count),
          OFFSET(state_variable_count),
          OFFSET(reserved),
          OFFSET(create),
          OFFSET(destroy),
          OFFSET(info),
          OFFSET(initialise),
          OFFSET(evaluate),
          OFFSET(extension)};
}

layout plugin_layout() {
  using T = ilaw_plugin;
  return {sizeof(T),    OFFSET(struct_size), OFFSET(abi_major), OFFSET(abi_minor),
          OFFSET(name), OFFSET(version),     OFFSET(vendor),    OFFSET(licence),
          OFFSET(laws), OFFSET(law_count),   OFFSET(reserved),  OFFSET(extension)};
}

#undef OFFSET

// In the order of the header.
constexpr layout (*c_layouts[])() = {
    parameter_layout, state_variable_layout, argument_layout, setup_layout, info_layout,  input_layout,
    output_layout,    batch_layout,          report_layout,   law_layout,   plugin_layout};
constexpr int struct_count = std::size(c_layouts);

layout c_layout(int structure) { return c_layouts[structure](); }

layout fortran_layout(int structure) {
  layout found(64);
  found.resize(static_cast<std::size_t>(fortran_layout_of(structure, found.data())));
  return found;
}

TEST(FortranModule, LaysOutEveryStructAsC) {
  for (int structure = 0; structure < struct_count; ++structure)
    EXPECT_EQ(fortran_layout(structure), c_layout(structure)) << "struct " << structure << " of ilaw.h";
}

TEST(FortranModule, DeclaredVariablesKnowTheirSize) {
  std::int32_t sizes[struct_count];
  fortran_struct_sizes(sizes);
  for (int structure = 0; structure < struct_count; ++structure)
    if (sizes[structure] != -1) {
      EXPECT_EQ(sizes[structure], c_layout(structure)[0]) << "struct " << structure << " of ilaw.h";
    }
}

TEST(FortranModule, DeclaredBatchIsEmptyAndCountsFromOne) {
  const ilaw_batch batch = fortran_default_batch();
  EXPECT_EQ(batch.index_base, 1);
  EXPECT_EQ(batch.node_count, 0);
  EXPECT_EQ(batch.index, nullptr);
  EXPECT_EQ(batch.index64, nullptr);
  EXPECT_EQ(batch.flags, 0U);
  for (const ilaw_input& input : {batch.v_free, batch.delassus, batch.gap, batch.gap_offset, batch.v_previous,
                                  batch.area, batch.normal, batch.tangent, batch.state_in})
    EXPECT_EQ(input.values, nullptr);
  for (const ilaw_output& output : {batch.state_out, batch.impulse, batch.velocity, batch.energy})
    EXPECT_EQ(output.values, nullptr);
  EXPECT_EQ(batch.status, nullptr);
}

TEST(FortranModule, HasEveryEnumeratorWithItsValue) {
  std::int32_t values[std::size(c_enumerators)];
  fortran_enumerators(values);
  for (std::size_t k = 0; k < std::size(c_enumerators); ++k)
    EXPECT_EQ(values[k], c_enumerators[k]) << "enumerator " << k << " of ilaw.h";
}

double read(const ilaw_input& input, std::int64_t node, std::int64_t component) {
  return input.values[node * input.node_stride + component * input.component_stride];
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
  const ilaw_input input = fortran_input(s.number);
  for (std::int64_t node = 0; node < s.nodes; ++node)
    for (std::int64_t component = 0; component < s.components; ++component)
      EXPECT_EQ(read(input, node, component), s.first + s.per_node * static_cast<double>(node) +
                                                  s.per_component * static_cast<double>(component))
          << "node " << node << ", component " << component;
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

TEST(FortranModule, EmptyArrayIsAbsent) { EXPECT_EQ(fortran_input(8).values, nullptr); }

TEST(FortranModule, OutputsAreTheArraysThatInputsAre) {
  const int same_as_input[] = {0, 1, 4};
  for (int section = 0; section < 3; ++section) {
    const ilaw_output output = fortran_output(section);
    const ilaw_input input = fortran_input(same_as_input[section]);
    EXPECT_EQ(output.values, input.values) << "section " << section;
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
  EXPECT_NE(negative.message.find("friction"), std::string::npos) << negative.message;
  EXPECT_NE(negative.message.find("-2"), std::string::npos) << negative.message;
  const creation choice = create(2);
  EXPECT_EQ(choice.code, ILAW_INVALID_PARAMETER);
  EXPECT_NE(choice.message.find("sometimes"), std::string::npos) << choice.message;
  EXPECT_NE(choice.message.find("predictive"), std::string::npos) << choice.message;
  const creation none = create(7);
  EXPECT_EQ(none.code, ILAW_INVALID_PARAMETER);
  EXPECT_NE(none.message.find("friction"), std::string::npos) << none.message;
  const creation table = create(4);
  EXPECT_EQ(table.code, ILAW_INVALID_PARAMETER);
  EXPECT_NE(table.message.find("friction"), std::string::npos) << table.message;
}

TEST(FortranModule, HandsOverWhyALibraryOrLawIsNotFound) {
  const creation law = create(6);
  EXPECT_EQ(law.code, ILAW_NOT_FOUND);
  EXPECT_NE(law.message.find("absent"), std::string::npos) << law.message;
  EXPECT_NE(law.message.find("coulomb"), std::string::npos) << law.message;
  const creation library = create(0, "/no/such/library.so");
  EXPECT_EQ(library.code, ILAW_NOT_FOUND);
  EXPECT_NE(library.message.find("/no/such/library.so"), std::string::npos) << library.message;
}

}  // namespace
