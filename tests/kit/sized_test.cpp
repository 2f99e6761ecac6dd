// Structs of other minor versions: what is shorter than 1.0 is refused, what is longer is served, and nobody
// reads or writes beyond the size that the other side names.
#include "support/law_runner.hpp"
#include "support/small_batch.hpp"

#include <cstring>

namespace ilaw::testing {
namespace {

// A struct with what a later minor version would append.
template <class Struct>
struct Longer {
  Longer() {
    std::memset(appended, 0x5a, sizeof appended);
    known.struct_size = sizeof *this;
  }
  bool is_untouched() const {
    for (const unsigned char byte : appended)
      if (byte != 0x5a) return false;
    return true;
  }
  Struct known{};
  unsigned char appended[40];
};

TEST(Sized, BatchesAreReadUpToTheirSizeAndFromThatOfVersionOneOn) {
  const SetupBuilder setup({{{"friction", 0.5}}, {}});
  const ilaw::interface law = make_law("coulomb", setup);
  SmallBatch node(1, {-1.0, 2.0, 0.0});
  Longer<ilaw_batch> batch;
  batch.known = node.b;
  batch.known.struct_size = sizeof batch;
  EXPECT_EQ(law.evaluate(batch.known), ILAW_OK);
  EXPECT_EQ(node.r[0][1], -0.5);
  for (const std::size_t size : {std::size_t{0}, offsetof(ilaw_batch, velocity), ILAW_BATCH_SIZE_1_0 - 1})
    for (const auto call : {law.law().evaluate, law.law().initialise}) {
      batch.known.struct_size = static_cast<std::uint32_t>(size);
      node.r[0][1] = 7.0;
      EXPECT_EQ(call(law.instance(), &batch.known, &node.report), ILAW_INVALID_ARGUMENT) << size;
      EXPECT_STREQ(node.report.reason, "struct_size of the batch is none of any version");
      EXPECT_EQ(node.r[0][1], 7.0);
    }
}

TEST(Sized, ReportsAreWrittenUpToTheirSize) {
  const SetupBuilder setup({{{"friction", 0.5}}, {}});
  const ilaw::interface law = make_law("coulomb", setup);
  const SmallBatch node(1, {-1.0, 2.0, 0.0});
  Longer<ilaw_report> report;
  report.known.bad_count = 99;
  EXPECT_EQ(law.law().evaluate(law.instance(), &node.b, &report.known), ILAW_OK);
  EXPECT_EQ(report.known.bad_count, 0);
  EXPECT_EQ(report.known.struct_size, sizeof report);
  EXPECT_TRUE(report.is_untouched());
  report.known.struct_size = ILAW_REPORT_SIZE_1_0 - 8;
  report.known.bad_count = 99;
  EXPECT_EQ(law.law().evaluate(law.instance(), &node.b, &report.known), ILAW_INVALID_ARGUMENT);
  EXPECT_EQ(report.known.bad_count, 99);
}

TEST(Sized, InfosAreWrittenUpToTheirSize) {
  const SetupBuilder setup({{{"friction", 0.5}}, {}});
  const ilaw::interface law = make_law("coulomb", setup);
  Longer<ilaw_instance_info> info;
  EXPECT_EQ(law.law().info(law.instance(), &info.known), ILAW_OK);
  EXPECT_EQ(info.known.state_version, 1U);
  EXPECT_EQ(info.known.struct_size, sizeof info);
  EXPECT_TRUE(info.is_untouched());
  info.known.struct_size = ILAW_INSTANCE_INFO_SIZE_1_0 - 1;
  info.known.state_version = 99;
  EXPECT_EQ(law.law().info(law.instance(), &info.known), ILAW_INVALID_ARGUMENT);
  EXPECT_EQ(info.known.state_version, 99U);
}

TEST(Sized, SetupsAndArgumentsAreReadUpToTheirSizeAndFromThatOfVersionOneOn) {
  const ilaw::library library(plugin_file("coulomb"));
  const ilaw_law& law = *library.law("coulomb");
  Longer<ilaw_argument> argument;
  argument.known.name = "friction";
  argument.known.number = 0.5;
  const ilaw_argument* const arguments[] = {&argument.known};
  Longer<ilaw_setup> setup;
  setup.known.dimension = 3;
  setup.known.delassus_form = ILAW_DELASSUS_SCALAR;
  setup.known.frame = ILAW_FRAME_LOCAL;
  setup.known.numbers = ILAW_NUMBERS_DOUBLE;
  setup.known.arguments = arguments;
  setup.known.argument_count = 1;
  char message[200];
  ilaw_instance* instance = nullptr;
  const auto create = [&] { return law.create(law.id, &setup.known, &instance, message, sizeof message); };
  EXPECT_EQ(create(), ILAW_OK) << message;
  law.destroy(instance);
  argument.known.struct_size = ILAW_ARGUMENT_SIZE_1_0 - 1;
  EXPECT_EQ(create(), ILAW_INVALID_ARGUMENT);
  const auto from = [](std::size_t size) { return "from " + std::to_string(size) + " to 4096"; };
  EXPECT_EQ(message, "law 'coulomb': argument 0 is null, has no name or a struct_size not " +
                         from(ILAW_ARGUMENT_SIZE_1_0));
  argument.known.struct_size = sizeof argument;
  setup.known.struct_size = ILAW_SETUP_SIZE_1_0 - 1;
  EXPECT_EQ(create(), ILAW_INVALID_ARGUMENT);
  EXPECT_EQ(message, "law 'coulomb': setup is null or its struct_size not " + from(ILAW_SETUP_SIZE_1_0));
  EXPECT_EQ(instance, nullptr);
}

// A size that no version has was never set: what follows it cannot be trusted either.
TEST(Sized, SizesThatNoVersionHasAreRefused) {
  const SetupBuilder setup({{{"friction", 0.5}}, {}});
  const ilaw::interface law = make_law("coulomb", setup);
  const SmallBatch node(1, {-1.0, 2.0, 0.0});
  ilaw_batch batch = node.b;
  ilaw_report report{};
  ilaw_instance_info info{};
  ilaw_setup other = setup.setup;
  ilaw_instance* instance = nullptr;
  for (const std::uint32_t size : {4097U, 0xFFFFFFFFU}) {
    GIVEN(size);
    report.struct_size = sizeof report;
    batch.struct_size = size;
    EXPECT_EQ(law.law().evaluate(law.instance(), &batch, &report), ILAW_INVALID_ARGUMENT);
    EXPECT_STREQ(report.reason, "struct_size of the batch is none of any version");
    batch.struct_size = sizeof batch;
    report = {};
    report.struct_size = size;
    EXPECT_EQ(law.law().evaluate(law.instance(), &batch, &report), ILAW_INVALID_ARGUMENT);
    EXPECT_EQ(report.reason, nullptr);
    info.struct_size = size;
    EXPECT_EQ(law.law().info(law.instance(), &info), ILAW_INVALID_ARGUMENT);
    other.struct_size = size;
    EXPECT_EQ(law.law().create("coulomb", &other, &instance, nullptr, 0), ILAW_INVALID_ARGUMENT);
  }
}

}  // namespace
}  // namespace ilaw::testing
