"""The words of theorems: sentences that follow from what is proved, as values."""

from orbitproof.verify.words.branches import BranchConclusion, branch_in_full, conclusion_in_words
from orbitproof.verify.words.catalogue import catalogue_in_words
from orbitproof.verify.words.curve import times_are_of_quarters
from orbitproof.verify.words.formulas import equations, setting
from orbitproof.verify.words.index import index_in_words
from orbitproof.verify.words.place import place_in_words
from orbitproof.verify.words.row_in_full import in_full, theorem_in_words
from orbitproof.verify.words.web import web_in_words
