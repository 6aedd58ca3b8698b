#pragma once

#include <functional>
#include <string>
#include <vector>

#include "organ_collision/core/triangle_mesh.h"
#include "tools/arguments.h"
#include "tools/program.h"

namespace organ_collision::bench {

/// A main(), as tools::runProgram() is: takes Google Benchmark's options off the command line and
/// hands the others to `run`. Unless told otherwise, repetitions of all benchmarks are run in
/// random order, so that whatever else the machine does hits all.
int runGoogleBenchmark(const tools::Program& program, int count, char** words,
                       const std::vector<std::string>& options,
                       const std::function<void(const tools::Arguments&)>& run);

/// Writes name and size of the organ into the results.
void tellOrgan(const std::string& name, const core::TriangleMesh& mesh);

}  // namespace organ_collision::bench
