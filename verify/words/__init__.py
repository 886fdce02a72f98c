"""The words of theorems: sentences that follow from what is proved, as values. Each module is imported by itself."""
