#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace duet {

/// The name that a misspelt one was probably meant to be: the candidate with the fewest insertions,
/// deletions, replacements and swaps of neighbours (case does not count), the first of equals;
/// empty where none is near (more than a third of the letters, at least two, differ). A candidate
/// that the name is the first words of ("t_d" of "t_d_s") comes before all others, the shortest of
/// them first.
[[nodiscard]] std::string NearestName(std::string_view name,
                                      const std::vector<std::string>& candidates);

/// "; did you mean 'X'?" or, where nothing is near, nothing: to end an error's sentence with.
[[nodiscard]] std::string DidYouMean(std::string_view name,
                                     const std::vector<std::string>& candidates);

}  // namespace duet
