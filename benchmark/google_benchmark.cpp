#include "google_benchmark.h"

#include <benchmark/benchmark.h>

#include <filesystem>
#include <iostream>

namespace organ_collision::bench {

int runGoogleBenchmark(const tools::Program& program, int count, char** words,
                       const std::vector<std::string>& options,
                       const std::function<void(const tools::Arguments&)>& run) {
  const auto initialize_and_run = [&](const std::vector<std::string>& /*words*/) {
    std::string shuffled = "--benchmark_enable_random_interleaving=true";
    std::string repeated = "--benchmark_repetitions=9";
    std::vector<char*> all = {words[0], shuffled.data(), repeated.data()};
    all.insert(all.end(), words + 1, words + count);  // what is said later wins
    int left = static_cast<int>(all.size());
    benchmark::Initialize(&left, all.data());
    run(tools::Arguments({all.begin() + 1, all.begin() + left}, options));
  };
  return tools::runProgram(program, {words + 1, words + count}, std::cout, std::cerr,
                           initialize_and_run);
}

void tellOrgan(const std::string& name, const core::TriangleMesh& mesh) {
  benchmark::AddCustomContext("organ", std::filesystem::path(name).filename().string());
  benchmark::AddCustomContext("triangles", std::to_string(mesh.triangleCount()));
}

}  // namespace organ_collision::bench
