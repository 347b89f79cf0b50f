"""Times of the rows of a table: `dates` reads texts, `clock` chooses the column and its unit, `counter` goes on where one overflows."""
