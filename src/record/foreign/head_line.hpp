// What a line above the rows of a foreign table says.
#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "record/foreign/field_text.hpp"

namespace pneuservo {

/// The fields of a line, both signs being commas or not.
std::vector<std::string> names_in(const std::string& line, const FieldStyle& style);

bool is_units_row(const std::vector<std::string>& fields);

/// "double,double,int", "f8,f8,u16": what some exports write below the names.
bool is_types_row(const std::vector<std::string>& fields);

/// "-----|-----" and the like: drawn, not written.
bool is_ruled(const std::vector<std::string>& fields);

/// "length=3000", "Serno: 2", "sample rate = 1000 Hz" in each field: what is known of a channel, not its name.
bool states_values(const std::vector<std::string>& fields, const FieldStyle& style);

/// Fields of a line above the rows, without the semicolon that marks a comment before names between semicolons.
std::vector<std::string> head_fields(const std::string& line, const FieldStyle& style, std::size_t fields);

/// The names in a line above rows between blanks, which may have blanks themselves: two stand between names, or what is
/// in brackets belongs to the one before.
std::vector<std::string> names_with_blanks(const std::string& line, std::size_t fields);

/// "type" of "Type: double,Type: int": what stands before the colon in every field; empty where fields differ in it.
std::string common_label(const std::vector<std::string>& fields);

/// "Scale,1,0.01": a line that states factors other than 1 or offsets other than 0 of the columns.
bool states_factors(const std::vector<std::string>& fields, const FieldStyle& style, std::size_t columns);

bool is_unit_label(const std::vector<std::string>& fields);

/// What a line above the rows can be.
enum class HeadLine { other, names, longer, units, types, ruled, stated };

/// The fields are joined where names between blanks have blanks themselves, and labels of units are taken off.
HeadLine judge_head_line(std::vector<std::string>& here, const std::string& line, std::size_t fields,
                         const FieldStyle& style);

}  // namespace pneuservo
