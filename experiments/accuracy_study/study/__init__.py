"""The package compared with the reference, case by case; tables, picture and statements; the command."""
