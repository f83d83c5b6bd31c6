// SPDX-License-Identifier: BSD-3-Clause
// Every input that is kept in corpus/ passes its target: seeds, and what once made one fail.
#include "targets.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>

namespace rbs::fuzz {
namespace {

namespace fs = std::filesystem;

void replay(const char* name, void (*target)(const std::uint8_t*, std::size_t)) {
  int inputs = 0;
  for (const fs::directory_entry& entry : fs::directory_iterator(fs::path(RBS_FUZZ_CORPUS) / name)) {
    SCOPED_TRACE(entry.path().string());
    std::ifstream stream(entry.path(), std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
    EXPECT_NO_THROW(target(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()));
    ++inputs;
  }
  EXPECT_GT(inputs, 0);
}

TEST(FuzzCorpus, scene) {
  replay("scene", scene);
}
TEST(FuzzCorpus, savedState) {
  replay("saved_state", savedState);
}
TEST(FuzzCorpus, mesh) {
  replay("mesh", mesh);
}
TEST(FuzzCorpus, world) {
  replay("world", world);
}

}  // namespace
}  // namespace rbs::fuzz
