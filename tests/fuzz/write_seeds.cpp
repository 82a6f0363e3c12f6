// write_seeds FOLDER: the seeds as files FOLDER/EXTENSION/NUMBER, for scripts/fuzz.

#include <filesystem>
#include <fstream>
#include <iostream>

#include "tests/fuzz/seeds.h"

int main(int count, char** arguments) {
  if (count != 2) {
    std::cerr << "write_seeds FOLDER\n";
    return 2;
  }
  int number = 0;
  for (const auto& [extension, bytes] : fettle::tests::fuzzSeeds()) {
    const auto folder = std::filesystem::path(arguments[1]) / extension.substr(1);
    std::filesystem::create_directories(folder);
    std::ofstream(folder / std::to_string(number++), std::ios::binary) << bytes;
  }
  return 0;
}
