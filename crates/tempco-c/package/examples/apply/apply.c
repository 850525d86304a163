/* apply: removes the bias from a log, as `tempco apply` does, to the byte.

       apply table.bin log.csv > out.csv

   The log has the columns time_s, temp_c and three axes, in the unit of the table, and rows that are
   0.1 s apart or more. It shows the image reader and the single step on an operating system. */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tempco.h"

enum { AXES = 3, LINE = 512, IMAGE = 65536, MOST_INTERVALS = 65536 };

/* An image must lie at an address divisible by 4. */
static union {
    uint32_t words[IMAGE / 4];
    unsigned char bytes[IMAGE];
} image;

static double intervals_s[MOST_INTERVALS];

static int fail(const char *what, const char *why)
{
    fprintf(stderr, "%s: %s\n", what, why);
    return 2;
}

/* Reads a row of numbers; returns how many there are. */
static int numbers(const char *line, double *values, int most)
{
    int count = 0;
    char *end;
    while (count < most) {
        values[count] = strtod(line, &end);
        if (end == line) {
            break;
        }
        count++;
        if (*end != ',') {
            break;
        }
        line = end + 1;
    }
    return count;
}

static int compare(const void *a, const void *b)
{
    const double x = *(const double *)a;
    const double y = *(const double *)b;
    return (x > y) - (x < y);
}

/* The median time between rows. */
static double median_interval_s(FILE *log)
{
    char line[LINE];
    double row[2 + AXES], last_s = 0.0;
    size_t rows = 0, count = 0;
    while (fgets(line, LINE, log) != NULL) {
        if (numbers(line, row, 2 + AXES) != 2 + AXES) {
            continue;
        }
        if (rows++ > 0 && count < MOST_INTERVALS) {
            intervals_s[count++] = row[0] - last_s;
        }
        last_s = row[0];
    }
    if (count == 0) {
        return 0.0;
    }
    qsort(intervals_s, count, sizeof intervals_s[0], compare);
    return count % 2 == 1 ? intervals_s[count / 2]
                          : 0.5 * (intervals_s[count / 2 - 1] + intervals_s[count / 2]);
}

/* Writes a number with as few digits as it takes to read it again, and without an exponent. */
static void put_number(double value, int is_float)
{
    char text[40];
    int digits, point, length;
    const char *mantissa = text;
    for (digits = 0; digits < 17; digits++) {
        snprintf(text, sizeof text, "%.*e", digits, value);
        if (is_float ? strtof(text, NULL) == (float)value : strtod(text, NULL) == value) {
            break;
        }
    }
    if (strchr(text, 'e') == NULL) { /* not a number */
        fputs(value != value ? "NaN" : value < 0 ? "-inf" : "inf", stdout);
        return;
    }
    if (*mantissa == '-') {
        putchar(*mantissa++);
    }
    point = atoi(strchr(mantissa, 'e') + 1) + 1; /* digits before the decimal point */
    text[strcspn(text, "e")] = 0;
    /* The digits alone. */
    if (mantissa[1] == '.') {
        memmove(text + (mantissa - text) + 1, mantissa + 2, strlen(mantissa + 2) + 1);
    }
    length = (int)strlen(mantissa);
    if (point <= 0) {
        fputs("0.", stdout);
        for (; point < 0; point++) {
            putchar('0');
        }
        fputs(mantissa, stdout);
    } else {
        for (digits = 0; digits < point || digits < length; digits++) {
            if (digits == point) {
                putchar('.');
            }
            putchar(digits < length ? mantissa[digits] : '0');
        }
    }
}

static void put_status(uint16_t status)
{
    uint32_t left = status;
    do {
        fputs(tempco_status_name((uint16_t)left), stdout);
        left &= left - 1u;
        if (left != 0) {
            putchar('+');
        }
    } while (left != 0);
    putchar('\n');
}

/* The names of the columns that come out: "x_dph" becomes "x_raw_dph" and two more. */
static int put_header(char *line)
{
    char *column;
    int count = 0;
    line[strcspn(line, "\r\n")] = 0;
    for (column = strtok(line, ","); column != NULL; column = strtok(NULL, ",")) {
        char *unit = strrchr(column, '_');
        if (unit == NULL) {
            return 0;
        }
        if (count++ < 2) {
            printf("%s%s", count > 1 ? "," : "", column);
            continue;
        }
        *unit++ = 0;
        printf(",%s_raw_%s,%s_bias_%s,%s_compensated_%s", column, unit, column, unit, column, unit);
    }
    puts(",status");
    return count == 2 + AXES;
}

static int apply(const tempco3_table_t *table, FILE *log)
{
    tempco3_compensator_t compensator;
    char line[LINE];
    double row[2 + AXES], last_s = 0.0;
    int axis, is_first = 1;
    const double interval_s = median_interval_s(log);

    if (interval_s < 0.1 * (1.0 - 0.01)) {
        return fail("log", "rows must be 0.1 s apart or more");
    }
    if (tempco3_compensator_init(&compensator, table) != TEMPCO_OK) {
        return fail("compensator", "not made");
    }
    rewind(log);
    if (fgets(line, LINE, log) == NULL || !put_header(line)) {
        return fail("log", "expected the columns time_s,temp_c and three axes");
    }
    while (fgets(line, LINE, log) != NULL) {
        tempco_interval_t interval;
        tempco3_output_t out;
        float raw[AXES], temp_c;
        if (numbers(line, row, 2 + AXES) != 2 + AXES) {
            return fail("log", "a row without five numbers");
        }
        temp_c = (float)row[1];
        for (axis = 0; axis < AXES; axis++) {
            raw[axis] = (float)row[2 + axis];
        }
        if (is_first) {
            tempco3_start(&compensator, temp_c);
            last_s = row[0] - interval_s;
            is_first = 0;
        }
        tempco3_interval_init(&interval, table, (float)(row[0] - last_s));
        last_s = row[0];
        tempco3_step(&compensator, &interval, temp_c, raw, &out);

        put_number(row[0], 0);
        putchar(',');
        put_number((double)temp_c, 1);
        for (axis = 0; axis < AXES; axis++) {
            putchar(',');
            put_number((double)raw[axis], 1);
            putchar(',');
            put_number((double)out.bias[axis], 1);
            putchar(',');
            put_number((double)out.compensated[axis], 1);
        }
        putchar(',');
        put_status(out.status);
    }
    return 0;
}

int main(int argc, char **argv)
{
    tempco3_table_t table;
    int32_t code;
    size_t length;
    int result;
    FILE *file;

    if (argc != 3) {
        return fail("usage", "apply table.bin log.csv > out.csv");
    }
    file = fopen(argv[1], "rb");
    if (file == NULL) {
        return fail(argv[1], "cannot be opened");
    }
    length = fread(image.bytes, 1, IMAGE, file);
    fclose(file);
    code = tempco3_table_from_image(&table, image.bytes, length, 0);
    if (code != TEMPCO_OK) {
        return fail(argv[1], tempco_strerror(code));
    }
    file = fopen(argv[2], "r");
    if (file == NULL) {
        return fail(argv[2], "cannot be opened");
    }
    result = apply(&table, file);
    fclose(file);
    return result;
}
