#pragma once

#include <string_view>
#include <vector>

#include "server/import/table_reader.h"
#include "server/named_parameters.h"

namespace spoor {

enum class NamedKeys { all, of_material };

/// Reads a scene's [thesis] table, or what a [[material]] table says of how it moves: the values given there, each
/// within its range. What is wrong goes to the reader's SceneErrors.
std::vector<NamedValue> readNamedValues(TableReader& table, NamedKeys keys);

/// Writes a table's values to the settings; what does not go is reported with its key, and so is what is noted.
void applyToTable(const std::vector<NamedValue>& values, std::int32_t cell_q, TableReader& table,
                  NamedSettings& settings, std::vector<std::string>& notes);

/// The range of a parameter that has one.
Range namedRange(std::string_view name);

/// Reports two keys of two tables that say the same, where both are given.
void refuseBoth(TableReader& thesis, std::string_view key, const TableReader& other, std::string_view other_key);

/// Compiles a scene's [soil] and [thesis] to its pack of one material, whose cell size is set. A preset comes first,
/// the keys beside it override it. Slopes rest up to kDefaultReposeDeg where neither table says anything.
void readSoil(TableReader& soil, TableReader& thesis, const std::vector<NamedValue>& named, ScenePack& pack,
              std::vector<std::string>& notes);

}  // namespace spoor
