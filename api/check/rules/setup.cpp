// Rules: setups that a law does not serve, structs of other versions, messages.
// SPDX-License-Identifier: BSD-3-Clause
#include "check/rule.hpp"

#include "check/sandbox.hpp"

#include <algorithm>
#include <array>
#include <cstring>

namespace ilaw::check {
namespace {

bool is_single(std::uint32_t mask) { return mask != 0 && (mask & (mask - 1)) == 0; }

// Each value of a member of the setup that the law does not serve.
template <class Member, class Value>
void expect_unserved(const Trial& trial, const char* what, Member ilaw_setup::*member, Value value) {
  expect_refused(trial, trial.values, ILAW_UNSUPPORTED, joined(what, value),
                 [=](SetupStruct& setup) { setup.given.*member = value; });
}

void setup_unserved(const Subject& subject) {
  const Trial trial = any_trial(subject);
  for (std::uint32_t d = 0; d <= 5; ++d) {
    const bool has_form = d == 3 || !trial.setup.spins();
    if (!has_form || d < 1 || d > 3 || !(subject.law.dimensions & (1U << d)))
      expect_unserved(trial, "dimension ", &ilaw_setup::dimension, d);
  }
  for (const std::uint32_t form : {0U, 1U, 2U, 3U, 4U, 8U, 16U})
    if (!is_single(form) || !(subject.law.delassus_forms & form))
      expect_unserved(trial, "H of form ", &ilaw_setup::delassus_form, form);
}

// Each exactly one entry of the law's mask: none, several and unknown ones are refused.
Judge refuses_choices(const char* what, std::uint32_t ilaw_setup::*member, std::uint32_t ilaw_law::*served) {
  return {Needs::instance, [=](const Subject& subject) {
            const Trial trial = any_trial(subject);
            for (const std::uint32_t choice : {0U, 1U, 2U, 3U, 4U, 7U, 1U << 31})
              if (!is_single(choice) || !(choice & subject.law.*served & 3U))
                expect_unserved(trial, what, member, choice);
          }};
}

void setup_flags(const Subject& subject) {
  const Trial trial = any_trial(subject);
  for (const int bit : {0, 31, 63})
    expect_unserved(trial, "flags ", &ilaw_setup::flags, std::uint64_t{1} << bit);
}

void create_id(const Subject& subject) {
  const Trial trial = any_trial(subject);
  const SetupStruct given(trial.setup, trial.values);
  for (const std::string& id :
       {std::string("nobody_has_this"), std::string(), std::string(subject.law.id) + "_"}) {
    ilaw_instance* made = nullptr;
    set_setting(joined(trial.text(), "; id '", id, "'"));
    calling("create");
    const std::int32_t code = subject.law.create(id.c_str(), &given.given, &made, nullptr, 0);
    if (code >= 0 || made)
      fail(trial,
           joined("create returned ", code, (made ? " and an instance" : ""), " for the id '", id, "'"),
           "a refusal: the library has no such law");
  }
}

void sizes_short(const Subject& subject) {
  const Trial trial = any_trial(subject);
  const auto expect_code = [&](std::int32_t code, const char* what) {
    if (code != ILAW_INVALID_ARGUMENT)
      fail(trial, joined(what, " returned ", code, " for a struct smaller than that of version 1.0"),
           "ILAW_INVALID_ARGUMENT (-1)");
  };
  for (const std::uint32_t size : {0U, static_cast<std::uint32_t>(ILAW_SETUP_SIZE_1_0) - 1})
    expect_refused(trial, trial.values, ILAW_INVALID_ARGUMENT, joined("a setup of ", size, " bytes"),
                   [size](SetupStruct& setup) { setup.given.struct_size = size; });
  for (std::size_t k = 0; k < trial.values.size(); ++k)
    expect_refused(trial, trial.values, ILAW_INVALID_ARGUMENT, "a short argument", [k](SetupStruct& setup) {
      setup.arguments[k].struct_size = static_cast<std::uint32_t>(ILAW_ARGUMENT_SIZE_1_0) - 1;
    });
  ilaw_instance_info info{};
  info.struct_size = static_cast<std::uint32_t>(ILAW_INSTANCE_INFO_SIZE_1_0) - 1;
  calling("info");
  expect_code(trial.law.info(trial.instance.get(), &info), "info");
  Draw draw(subject.seed);
  const Script script = draw_script(trial, draw, {2, 1});
  Started arrays(trial, script[0]);
  ilaw_batch batch = arrays.batch();
  batch.struct_size = static_cast<std::uint32_t>(ILAW_BATCH_SIZE_1_0) - 1;
  expect_code(trial.instance.evaluate(batch, nullptr), "evaluate");
  expect_code(trial.instance.initialise(batch, nullptr), "initialise");
}

// A struct with what a later minor version would append.
template <class Struct>
struct Longer {
  explicit Longer(const Struct& value) : known(value) {
    std::memset(appended.data(), 0x5a, appended.size());
    known.struct_size = sizeof *this;
  }
  bool is_untouched() const {
    return std::all_of(appended.begin(), appended.end(), [](unsigned char byte) { return byte == 0x5a; });
  }
  Struct known;
  std::array<unsigned char, 40> appended;
};

void sizes_long(const Subject& subject) {
  // A library of a later version knows members that this one does not.
  const bool knows_more = subject.library.plugin().abi_minor > ILAW_ABI_MINOR;
  for_trials(subject, [knows_more](const Trial& trial, Draw& draw) {
    const SetupStruct given(trial.setup, trial.values);
    Longer<ilaw_setup> setup(given.given);
    const Script script = draw_script(trial, draw, {3, 1});
    Refusal refusal{};
    if (!create(trial.law, setup.known, refusal))
      fail(trial, joined("create returned ", refusal.code, " for a longer setup"), "ILAW_OK");
    Longer<ilaw_instance_info> info(ilaw_instance_info{});
    calling("info");
    if (trial.law.info(trial.instance.get(), &info.known) != ILAW_OK || !(knows_more || info.is_untouched()))
      fail(trial, "info wrote beyond the known struct, or refused a longer one", "members that it knows");
    Started arrays(trial, script[0]);
    arrays.evaluate(script[0]);
    Longer<ilaw_batch> batch(arrays.batch());
    ilaw_report blank{};
    Longer<ilaw_report> report(blank);
    const std::int32_t code = trial.instance.evaluate(batch.known, &report.known);
    if (code < 0 || !(knows_more || report.is_untouched()))
      fail(trial, joined("evaluate returned ", code, ", or wrote beyond the known report"),
           "ILAW_OK for structs of a later version");
    return true;
  });
}

// An instance must give the same while the setup exists and after it has become rubbish.
bool setup_copied(const Trial& trial, Draw& draw) {
  auto given = std::make_unique<SetupStruct>(trial.setup, trial.values);
  Refusal refusal{};
  const std::optional<Instance> made = create(trial.law, given->given, refusal);
  if (!made) return false;
  const Script script = draw_script(trial, draw);
  const auto results = [&] {
    Started arrays(trial, script[0]);
    std::vector<Results> all;
    for (const Inputs& in : script) all.push_back(arrays.evaluate_with(*made, in));
    return all;
  };
  const std::vector<Results> expected = results();
  given.reset();
  expect_same(trial, script, expected, results(), "once the setup was gone");
  return true;
}

bool is_line(const char* text) {
  for (; *text; ++text)
    if (static_cast<unsigned char>(*text) < 0x20 || *text == 0x7F) return false;
  return true;
}

void refusal_message(const Subject& subject) {
  const Trial trial = any_trial(subject);
  const Values values = with(trial.values, {"nobody_has_this", ILAW_KIND_VALUE_NUMBER, 1.0});
  const SetupStruct given(trial.setup, values);
  set_setting(joined(text_of(trial.setup), "; ", text_of(values)));
  for (const std::size_t size : {std::size_t{512}, std::size_t{8}, std::size_t{1}, std::size_t{0}}) {
    std::array<char, 513> text;
    text.fill('#');
    ilaw_instance* made = reinterpret_cast<ilaw_instance*>(text.data());
    calling("create");
    const std::int32_t code =
        trial.law.create(trial.law.id, &given.given, &made, size ? text.data() : nullptr, size);
    if (code == ILAW_OK) throw NotJudged{"the law accepts any parameter"};
    if (made) fail(trial, "a refusal left *instance set", "null");
    const auto beyond = std::find_if(text.begin() + static_cast<std::ptrdiff_t>(size), text.end(),
                                     [](char c) { return c != '#'; });
    if (beyond != text.end())
      fail(trial, joined("create wrote beyond the ", size, " bytes of the message"), "within them");
    if (size > 0 && !std::memchr(text.data(), 0, size))
      fail(trial, "the message has no zero at its end", joined("one within ", size, " bytes"));
    if (size == 512 && (text[0] == '\0' || !is_line(text.data())))
      fail(trial, joined("the message is \"", text.data(), "\""),
           "one line that says which parameter, its value and what is allowed");
  }
}

}  // namespace

std::vector<Rule> setup_rules() {
  return {
      {"setup-unserved",
       "A dimension or form of H that the law does not serve is refused, spins in 1D and 2D among them.",
       "ilaw.h, ilaw_setup", needing(Needs::instance, setup_unserved)},
      {"setup-frame", "A frame that is not exactly one entry of the law's mask is refused.",
       "ilaw.h, ilaw_setup", refuses_choices("frame ", &ilaw_setup::frame, &ilaw_law::frames)},
      {"setup-numbers", "A number type that is not exactly one entry of the law's mask is refused.",
       "ilaw.h, ilaw_setup", refuses_choices("number type ", &ilaw_setup::numbers, &ilaw_law::numbers)},
      {"create-id", "create makes no instance of a law that the library does not have.",
       "ilaw.h, ilaw_law.create", needing(Needs::instance, create_id)},
      {"setup-flags", "A bit of the setup's flags that the law does not know is refused.", "ilaw.h, Growth",
       needing(Needs::instance, setup_flags)},
      {"sizes-short", "A struct that is smaller than that of version 1.0 is refused.",
       "abi.md, How ABI 1 grows", needing(Needs::instance, sizes_short)},
      {"sizes-long", "Structs of later minor versions are served; nothing is written beyond what is known.",
       "abi.md, How ABI 1 grows", needing(Needs::motion, sizes_long)},
      {"setup-copied", "Nothing of the setup need outlive create.", "abi.md, ilaw_setup",
       on_trials(setup_copied)},
      {"refusal-message", "A refusal leaves no instance, and a message of one line within its bytes.",
       "ilaw.h, ilaw_law.create", needing(Needs::instance, refusal_message)}};
}

}  // namespace ilaw::check
