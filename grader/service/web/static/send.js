// What is only on its way to another site goes on by itself. Without scripts its button does the same.
document.querySelector("form[data-send]").submit();
