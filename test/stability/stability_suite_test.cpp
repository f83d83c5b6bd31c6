// SPDX-License-Identifier: BSD-3-Clause
// The hard cases as tests, one a case and setting; and with options, as the tool that scripts/stability runs.
//
//   stability_suite_test --list                     number, setting and title of each run, one a line
//   stability_suite_test --residuals [--full] [--case A05] [--fidelity reference] [--json]
//                                         what was measured, instead of pass or fail
#include "suite.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <exception>
#include <iostream>

namespace rbs::stability {
namespace {

/// Runs a case; an error that it throws is a figure that does not hold.
Sheet runCase(const Case& which, Fidelity setting, bool full_length) {
  Sheet sheet(setting, full_length);
  try {
    which.run(sheet);
  } catch (const std::exception& error) {
    sheet.check(std::string("runs to its end: ") + error.what(), false, every(0.0));
  }
  return sheet;
}

/// The entry of the list of known shortfalls; null where there is none.
const Shortfall* known(const Case& which, Fidelity setting, const Row& row) {
  for (const Shortfall& shortfall : knownShortfalls()) {
    if (shortfall.number == std::string(which.number) &&
        shortfall.setting == std::string(fidelityName(setting)) && shortfall.metric == row.metric) {
      return &shortfall;
    }
  }
  return nullptr;
}

/// A case at a setting, as a test.
class CaseTest : public testing::Test {
 public:
  CaseTest(const Case& which, Fidelity setting) : case_(which), setting_(setting) {}

  void TestBody() override {
    const Sheet sheet = runCase(case_, setting_, false);
    EXPECT_FALSE(sheet.rows().empty());
    for (const Row& row : sheet.rows()) {
      if (!row.bound) continue;
      if (known(case_, setting_, row)) {
        EXPECT_FALSE(row.holds()) << row.metric << " has come to hold: " << row.measured
                                  << "; take it off known_shortfalls.cpp";
      } else {
        EXPECT_TRUE(row.holds()) << row.metric << ": measured " << row.measured << " " << row.unit
                                 << ", reference " << row.reference << ", bound " << *row.bound;
      }
    }
  }

 private:
  Case case_;
  Fidelity setting_;
};

TEST(KnownShortfalls, nameCasesSettingsAndReasons) {
  for (const Shortfall& shortfall : knownShortfalls()) {
    bool found = false;
    for (const Case& which : allCases()) found |= std::string(which.number) == shortfall.number;
    EXPECT_TRUE(found) << shortfall.number;
    EXPECT_NE(std::string(shortfall.reason), "") << shortfall.number;
  }
}

void registerCases() {
  for (const Case& which : allCases()) {
    for (const Fidelity setting : kSettings) {
      testing::RegisterTest("Stability", (std::string(which.number) + "_" + fidelityName(setting)).c_str(),
                            nullptr, nullptr, __FILE__, __LINE__,
                            [=]() -> testing::Test* { return new CaseTest(which, setting); });
    }
  }
}

std::string quoted(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') result += '\\';
    result += c == '\n' ? ' ' : c;
  }
  return result + "\"";
}

/// JSON has no word for NaN and infinity.
std::string number(double value) {
  if (!std::isfinite(value)) return "null";
  char text[32];
  std::snprintf(text, sizeof text, "%.17g", value);
  return text;
}

void printTable(const Case& which, const Sheet& sheet) {
  for (const Row& row : sheet.rows()) {
    std::printf("| %s | %s | %s | %s%s", which.number, fidelityName(sheet.setting()), row.metric.c_str(),
                row.unit.c_str(), row.unit.empty() ? "" : " ");
    std::printf("| %.10g | %.3g | ", row.reference, row.measured - row.reference);
    if (row.bound)
      std::printf("%.3g | %s |\n", *row.bound, row.holds() ? "holds" : "FALLS SHORT");
    else
      std::printf("shown | |\n");
  }
  std::fflush(stdout);
}

void printJson(const Case& which, const Sheet& sheet) {
  std::string text = "{\"number\": " + quoted(which.number) + ", \"title\": " + quoted(which.title) +
                     ", \"text\": " + quoted(which.text) +
                     ", \"setting\": " + quoted(fidelityName(sheet.setting())) + ", \"rows\": [";
  const char* comma = "";
  for (const Row& row : sheet.rows()) {
    text += comma + std::string("{\"metric\": ") + quoted(row.metric) + ", \"unit\": " + quoted(row.unit) +
            ", \"measured\": " + number(row.measured) + ", \"reference\": " + number(row.reference) +
            ", \"bound\": " + (row.bound ? number(*row.bound) : "null") +
            ", \"holds\": " + (row.holds() ? "true" : "false");
    const Shortfall* shortfall = known(which, sheet.setting(), row);
    text += shortfall ? ", \"reason\": " + quoted(shortfall->reason) + "}" : "}";
    comma = ", ";
  }
  std::cout << text << "]}" << std::endl;
}

struct Options {
  bool list = false, residuals = false, full = false, json = false;
  std::string number, setting;
};

/// The options of the tool; googletest has taken its own.
Options parse(int argc, char** argv) {
  Options options;
  for (int k = 1; k < argc; ++k) {
    const std::string word = argv[k];
    if (word == "--list")
      options.list = true;
    else if (word == "--residuals")
      options.residuals = true;
    else if (word == "--full")
      options.full = true;
    else if (word == "--json")
      options.json = true;
    else if (word == "--case" && k + 1 < argc)
      options.number = argv[++k];
    else if (word == "--fidelity" && k + 1 < argc)
      options.setting = argv[++k];
    else
      throw std::invalid_argument("unknown option '" + word +
                                  "'; known: --list, --residuals, --full, --json, "
                                  "--case NUMBER, --fidelity SETTING");
  }
  return options;
}

int runTool(const Options& options) {
  int runs = 0;
  for (const Case& which : allCases()) {
    if (!options.number.empty() && options.number != which.number) continue;
    for (const Fidelity setting : kSettings) {
      if (!options.setting.empty() && options.setting != fidelityName(setting)) continue;
      ++runs;
      if (options.list) {
        std::printf("%s %s %s\n", which.number, fidelityName(setting), which.title);
        continue;
      }
      const Sheet sheet = runCase(which, setting, options.full);
      options.json ? printJson(which, sheet) : printTable(which, sheet);
    }
  }
  if (runs == 0) std::cerr << "no case '" << options.number << "' at setting '" << options.setting << "'\n";
  return runs == 0;
}

}  // namespace
}  // namespace rbs::stability

int main(int argc, char** argv) {
  using namespace rbs::stability;
  testing::InitGoogleTest(&argc, argv);
  try {
    const Options options = parse(argc, argv);
    if (options.list || options.residuals) return runTool(options);
  } catch (const std::exception& error) {
    std::cerr << error.what() << "\n";
    return 2;
  }
  registerCases();
  return RUN_ALL_TESTS();
}
