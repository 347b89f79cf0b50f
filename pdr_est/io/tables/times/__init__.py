"""Times of the rows of a table: `dates` reads texts, `clock` chooses column and unit, `counter` undoes overflows."""
