#include "program.h"

#include <algorithm>
#include <exception>
#include <new>
#include <stdexcept>

#include "arguments.h"

namespace organ_collision::tools {

int runProgram(const Program& program, const std::vector<std::string>& words, std::ostream& out,
               std::ostream& errors,
               const std::function<void(const std::vector<std::string>&)>& run) {
  try {
    if (std::find(words.begin(), words.end(), "--help") != words.end()) {
      out << program.usage;
    } else {
      run(words);
    }
    if (!out.flush()) throw std::runtime_error("its output could not be written");
    return 0;
  } catch (const UsageError& error) {
    errors << program.name << ": " << error.what() << "; --help shows how it is used" << std::endl;
    return 2;
  } catch (const std::bad_alloc&) {
    errors << program.name << ": there is not enough memory" << std::endl;
    return 1;
  } catch (const std::exception& error) {
    errors << program.name << ": " << error.what() << std::endl;
    return 1;
  }
}

}  // namespace organ_collision::tools
