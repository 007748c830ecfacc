#include "tools/input/csv.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <string>

namespace slamsensor::tools {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr std::array<CsvColumn, 3> kColumns{{{"a"}, {"b"}, {"c", CsvNeed::Optional}}};

std::string open_error(std::string_view text, CsvOthers others = CsvOthers::Refused) {
  const auto csv = CsvReader::open(text, "f.csv", kColumns, others);
  return csv ? "" : csv.error().message;
}

TEST(Csv, FindsColumnsByNameInAnyOrder) {
  auto csv = CsvReader::open("\xEF\xBB\xBF# note\r\n b , a\r\n\r\n2,1\r\n# between\r\n4 , 3", "f.csv",
                             kColumns, CsvOthers::Refused);
  ASSERT_TRUE(csv);
  EXPECT_FALSE(csv->has(2));
  ASSERT_TRUE(csv->next().value());
  EXPECT_EQ(csv->text(0), "1");
  EXPECT_EQ(csv->text(1), "2");
  ASSERT_TRUE(csv->next().value());
  EXPECT_EQ(csv->number(0, {0, 10, "m"}).value(), 3.0);
  EXPECT_EQ(csv->line(), 6U);
  EXPECT_FALSE(csv->next().value());
}

// The same two rows as programs and spreadsheets of several countries save them.
TEST(Csv, ReadsWhatSpreadsheetsWrite) {
  for (const std::string_view text : {
           "a,b,c\n1.5,-20,\n2,3,4\n",
           "\xEF\xBB\xBF\"a\",\"b\",\"c\"\r\n\"1.5\",\"-20\",\"\"\r\n\"2\",\"3\",\"4\"\r\n",
           "a;b;c\r\n1,5;-20;\r\n2;3,0;4\r\n",
           "sep=;\r\na;b;c\r\n\"1,5\";-2e1;\r\n2;3;4\r\n",
           "a\tb\tc\n1,5\t-20\t\n2\t3\t4\n",
           "sep=\t\n a \t \"b\"\tc\n1.5\t-20\t\n2\t3\t4",
       }) {
    auto csv = CsvReader::open(text, "f.csv", kColumns, CsvOthers::Refused);
    ASSERT_TRUE(csv) << text;
    ASSERT_TRUE(csv->next().value()) << text;
    EXPECT_EQ(csv->number(0, {0, 10, ""}).value(), 1.5) << text;
    EXPECT_EQ(csv->number(1, {-50, 10, ""}).value(), -20.0) << text;
    EXPECT_EQ(csv->text(2), "") << text;
    ASSERT_TRUE(csv->next().value()) << text;
    EXPECT_EQ(csv->number(1, {0, 10, ""}).value(), 3.0) << text;
    EXPECT_EQ(csv->whole_number(2, 10).value(), 4) << text;
    EXPECT_FALSE(csv->next().value()) << text;
  }
}

TEST(Csv, NamesWhatItCannotRead) {
  EXPECT_THAT(open_error(std::string_view("\xFF\xFE"
                                          "a\0,\0b\0",
                                          8)),
              HasSubstr("f.csv: is text in UTF-16"));
  EXPECT_THAT(open_error(std::string_view("\0a\0,\0b", 6)), HasSubstr("UTF-16"));
  const auto first_number_error = [](std::string_view text) {
    auto csv = CsvReader::open(text, "f.csv", kColumns, CsvOthers::Refused);
    const auto row = csv->next();
    return !row ? row.error().message : csv->number(0, {0, 1e9, ""}).error().message;
  };
  EXPECT_THAT(first_number_error("a,b\n1,5,2\n"), HasSubstr("3 fields where the header has 2"));
  EXPECT_THAT(first_number_error("a,b\n\"1,5\",2\n"), HasSubstr("a is '1,5'"));
  EXPECT_THAT(first_number_error("a;b\n1.234,5;2\n"), HasSubstr("a is '1.234,5'"));
  EXPECT_THAT(first_number_error("a;b\n1,234,567;2\n"), HasSubstr("a is '1,234,567'"));
  EXPECT_THAT(first_number_error("a,b\n\"1\"\"\",2\n"), HasSubstr("a is '1\"\"'"));
}

TEST(Csv, SaysWhatIsWrongWithAHeader) {
  EXPECT_THAT(open_error(""), AllOf(HasSubstr("f.csv"), HasSubstr("empty"), HasSubstr("a,b,c (optional)")));
  EXPECT_THAT(open_error("a,c\n"), AllOf(HasSubstr("f.csv:1"), HasSubstr("no column b")));
  EXPECT_THAT(open_error("#\na,b,a\n"), AllOf(HasSubstr("f.csv:2"), HasSubstr("'a' twice")));
  EXPECT_THAT(open_error("a,b,range\n"), AllOf(HasSubstr("'range' is not known"), HasSubstr("a,b,c")));
  EXPECT_EQ(open_error("a,b,range\n", CsvOthers::Ignored), "");
}

// A copy that broke off gave a range of 1 m where 12.345 m was measured.
TEST(Csv, NamesTheNumberThatTheEndOfTheFileCuts) {
  const auto last_error = [](const std::string& text) {
    auto csv = CsvReader::open(text, "f.csv", kColumns, CsvOthers::Refused);
    const auto rows = for_each_row(*csv, [] { return tl::expected<void, InputError>(); });
    return rows ? std::string() : rows.error().message;
  };
  const std::string rows = "a,b\n1,2.125\n2,3.250\n3,12.345\n";
  for (const char* const cut : {"4,12.34", "4,12.3", "4,12.", "4,12", "4,1"}) {
    EXPECT_THAT(last_error(rows + cut), AllOf(HasSubstr("f.csv:5"), HasSubstr("ends within the number")))
        << cut;
    EXPECT_EQ(last_error(rows + cut + "\n"), "") << cut;
  }
  EXPECT_EQ(last_error(rows + "4,12.345"), "") << "only the line end is missing";
  EXPECT_EQ(last_error("a,b\n1,2.125\n2,3.5\n3,12.345\n4,1"), "") << "as many decimals as it takes";
  EXPECT_EQ(last_error("a,b\n1,2.125\n2,3"), "") << "too few to tell";
  EXPECT_THAT(last_error(rows + "4"), HasSubstr("1 fields where the header has 2"));
}

TEST(Csv, RefusesRowsOfAnotherWidth) {
  auto csv = CsvReader::open("a,b\n1,2,3\n1\n", "f.csv", kColumns, CsvOthers::Refused);
  ASSERT_TRUE(csv);
  EXPECT_THAT(csv->next().error().message,
              AllOf(HasSubstr("f.csv:2"), HasSubstr("3 fields"), HasSubstr("has 2")));
  EXPECT_THAT(csv->next().error().message, HasSubstr("f.csv:3"));
}

TEST(Csv, RefusesWhatIsNoNumberInRange) {
  for (const char* value :
       {"", "nan", "inf", "-inf", "1x", "0x1", "1 2", "10.5", "-0.5", "1e400", "\x01\xFF"}) {
    const std::string text = std::string("a,b\n") + value + ",0\n";
    auto csv = CsvReader::open(text, "f.csv", kColumns, CsvOthers::Refused);
    ASSERT_TRUE(csv && csv->next().value());
    const auto number = csv->number(0, {0.0, 10.0, "m"});
    ASSERT_FALSE(number) << value;
    EXPECT_THAT(number.error().message, AllOf(HasSubstr("f.csv:2: a is '"), HasSubstr("from 0 to 10 m")));
  }
}

TEST(Csv, RefusesWhatIsNoWholeNumberInRange) {
  for (const char* value : {"", "-1", "1.0", "11", "99999999999999999999"}) {
    const std::string text = std::string("a,b\n") + value + ",0\n";
    auto csv = CsvReader::open(text, "f.csv", kColumns, CsvOthers::Refused);
    ASSERT_TRUE(csv && csv->next().value());
    EXPECT_FALSE(csv->whole_number(0, 10)) << value;
  }
}

TEST(Csv, MessagesShowNoControlBytesAndNoEndlessValues) {
  EXPECT_EQ(in_quotes("a\x1b[2J\xC3"), "'a?[2J?'");
  EXPECT_EQ(in_quotes(std::string(1000, 'z')), "'" + std::string(40, 'z') + "...'");
}

}  // namespace
}  // namespace slamsensor::tools
