"""A generated corpus of attempts: right ones of every kind, wrong ones with one defect, and harmless ones.

`attempts` says what is driven, `scripts` writes it as a student's script in many styles, `test_corpus` scores
all of it on the ideal turtle and a sample with everything real; ``python -m tests.corpus`` grades the whole
corpus with everything real and prints the confusion matrix.
"""
