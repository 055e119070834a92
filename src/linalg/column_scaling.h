/* src/linalg/column_scaling.h - the units of the columns of a matrix, found from its entries. */
#ifndef NS_LINALG_COLUMN_SCALING_H
#define NS_LINALG_COLUMN_SCALING_H

enum { NS_UNITS_LIST = 16, NS_UNITS_WORK = 7 + NS_UNITS_LIST };

/* unit (m): powers of two such that |W_ij| unit_j are alike over each row, for W m*m column by column.  They
 * follow the units of W: with column j multiplied by s, unit_j is divided by s, but for a common factor (one
 * for each set of rows and columns that no entry joins with the rest) and rounding to a power of two; what
 * the rows are multiplied by does not matter.  work: NS_UNITS_WORK*m. */
void ns_linalg_column_scaling(int m, const double *W, double *unit, double *work);

/* value (m): that of a row becomes the largest of all rows that entries of W join it with.  parent (m): work.
 */
void ns_linalg_spread(int m, const double *W, double *value, double *parent);

#endif
